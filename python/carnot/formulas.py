"""Scenes from formulas of sympy, which become texts in the language of scenes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Optional

import sympy
from sympy.printing.str import StrPrinter

from carnot.scene import Scene
from carnot.texts import number_text

FUNCTIONS = {
    name: name
    for name in (
        "sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "asin", "acos", "atan",
        "atan2",
    )
}  # fmt: skip

RECIPROCALS = {"sec": "cos", "csc": "sin", "sech": "cosh", "csch": "sinh"}


def scene_of(
    q: Sequence[Any],
    *,
    kinetic: Any = None,
    potential: Any = None,
    lagrangian: Any = None,
    constraints: Iterable[Any] = (),
    controls: Sequence[Any] = (),
    velocities: Optional[Sequence[Any]] = None,
    rates: Optional[Sequence[Any]] = None,
    cost: Any = None,
    parameters: Optional[Mapping[Any, float]] = None,
    angles: Iterable[Any] = (),
    units: Optional[Mapping[Any, str]] = None,
    name: str = "scene",
    **options: Any,
) -> Scene:
    """The scene of these formulas; `options` are those of Scene, such as limits.

    `q` are functions of time, x(t), whose derivatives are the velocities, or symbols, with their
    velocities in `velocities`. Given are `kinetic` and perhaps `potential`, or `lagrangian`, with
    `constraints` that vanish; or `controls`, `rates` (the velocity of each coordinate) and `cost`.
    `parameters` have their values, which the scene has as defaults. `angles` are coordinates of
    period 2 pi. What the language has no word for is a ValueError that names it.
    """
    if isinstance(q, str) or not all(isinstance(x, sympy.Basic) for x in q) or not q:
        raise ValueError(f"q {q!r}: accepted: symbols, or functions of time, at least one")
    if len(set(q)) != len(q):
        raise ValueError(f"q {q!r}: a coordinate is there twice; accepted: each once")
    if isinstance(constraints, sympy.Basic) and not isinstance(constraints, sympy.MatrixBase):
        constraints = [constraints]
    printer = _Printer(q, velocities, controls)
    angle_names = {printer.coordinate(x) for x in angles}
    unit_names = {printer.coordinate(x): unit for x, unit in (units or {}).items()}
    unit_names.update({x: "angle" for x in angle_names})
    coordinates = [
        f"{x} [{unit_names[x]}]" if x in unit_names else x for x in printer.coordinates
    ]
    lines = [f"coordinates {coordinate}" for coordinate in coordinates]
    for symbol, value in (parameters or {}).items():
        default = number_text(f"parameters {symbol}", value)
        lines.append(f"parameters {printer.doprint(symbol)} = {default}")
    if controls:
        lines.append("controls " + ", ".join(printer.doprint(u) for u in controls))
    given = {"kinetic": kinetic, "potential": potential, "lagrangian": lagrangian, "cost": cost}
    for word, formula in given.items():
        if formula is not None:
            lines.append(f"{word} = {printer.doprint(_scalar(word, formula))}")
    for constraint in constraints:
        zero = constraint.lhs - constraint.rhs if isinstance(constraint, sympy.Eq) else constraint
        lines.append(f"0 = {printer.doprint(_scalar('constraints', zero))}")
    if rates is not None and len(rates) != len(q):
        raise ValueError(f"rates: {len(rates)} of them; accepted: one for each of {len(q)}")
    for x, rate in zip(printer.coordinates, rates or ()):
        right = rate.rhs if isinstance(rate, sympy.Eq) else rate
        lines.append(f"{x}' = {printer.doprint(_scalar('rates', right))}")
    if isinstance(options.get("limits"), Mapping):
        options["limits"] = {
            printer.doprint(one) if isinstance(one, sympy.Basic) else one: bounds
            for one, bounds in options["limits"].items()
        }
    return Scene("\n".join(lines) + "\n", name=name, **options)


def _scalar(word: str, formula: Any) -> Any:
    formula = sympy.sympify(formula)
    if isinstance(formula, sympy.MatrixBase):
        if formula.shape != (1, 1):
            raise ValueError(f"{word}: a matrix of {formula.shape}; accepted: a formula")
        formula = formula[0, 0]
    return formula


class _Printer(StrPrinter):
    """Prints formulas in the language of scenes."""

    def __init__(
        self, q: Sequence[Any], velocities: Optional[Sequence[Any]], controls: Sequence[Any]
    ) -> None:
        super().__init__({"full_prec": False})
        if velocities is not None and len(velocities) != len(q):
            raise ValueError(
                f"velocities: {len(velocities)} of them; accepted: one for each of {len(q)} "
                "coordinates"
            )
        self.coordinates = [self._name(x) for x in q]
        self._names: dict[Any, str] = dict(zip(q, self.coordinates))
        times: set[Any] = set()
        for x in q:
            times |= set(x.args)
        if len(times) > 1:
            raise ValueError(f"q: functions of {times}; accepted: functions of one time")
        self._time = times.pop() if times else None
        for x, name in zip(q, self.coordinates):
            if x.args:
                self._names[x.diff(self._time)] = f"{name}'"
        self._names.update({u: self._name(u) for u in controls})
        for v, name in zip(velocities or (), self.coordinates):
            self._names[v] = f"{name}'"

    @staticmethod
    def _name(x: Any) -> str:
        return str(x.func.__name__ if x.args else x.name)

    def coordinate(self, x: Any) -> str:
        """The name of one of the coordinates."""
        if x not in self._names:
            raise ValueError(f"{x}: no coordinate; accepted: one of {self.coordinates}")
        return self._names[x]

    def _print(self, expr: Any, **kwargs: Any) -> str:
        known = self._names.get(expr) if isinstance(expr, sympy.Basic) else None
        if known is not None:
            return known
        if isinstance(expr, sympy.core.numbers.NumberSymbol) and expr not in (sympy.pi, sympy.E):
            raise ValueError(f"{expr}: no such number; accepted: numbers, pi, E")
        return str(super()._print(expr, **kwargs))

    def _print_Symbol(self, expr: Any) -> str:
        return "t" if expr == self._time else str(expr.name)

    def _print_Pow(self, expr: Any, rational: bool = False) -> str:
        base, exponent = expr.as_base_exp()
        if expr.exp == sympy.Rational(1, 2):
            return f"sqrt({self._print(expr.base)})"
        if expr.exp.is_number and expr.exp.is_negative:
            return f"(1 / ({self._print(expr.base ** -expr.exp)}))"
        if expr.base == sympy.E:
            return f"exp({self._print(expr.exp)})"
        return f"({self._print(expr.base)})^({self._print(expr.exp)})"

    def _print_Mul(self, expr: Any) -> str:
        return " * ".join(f"({self._print(factor)})" for factor in expr.args)

    def _print_Rational(self, expr: Any) -> str:
        return f"({expr.p} / {expr.q})"

    def _print_Integer(self, expr: Any) -> str:
        return str(expr.p)

    def _print_Float(self, expr: Any) -> str:
        return repr(float(expr))

    def _print_Exp1(self, expr: Any) -> str:
        return "exp(1)"

    def _print_Derivative(self, expr: Any) -> str:
        raise ValueError(f"{expr}: accepted: first derivatives of coordinates by time")

    def _print_Function(self, expr: Any) -> str:
        name = expr.func.__name__
        if name == "cot":
            return self._print(sympy.cos(expr.args[0]) / sympy.sin(expr.args[0]))
        if name in RECIPROCALS:
            return f"(1 / {RECIPROCALS[name]}({self._print(expr.args[0])}))"
        if name not in FUNCTIONS:
            raise ValueError(f"{expr}: no such function; accepted: {', '.join(FUNCTIONS)}")
        return f"{FUNCTIONS[name]}({', '.join(self._print(a) for a in expr.args)})"

    def _print_Pi(self, expr: Any) -> str:
        return "pi"
