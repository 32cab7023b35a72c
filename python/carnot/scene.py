"""Scenes: systems with their parameters, and what can be computed with them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from carnot import _carnot, texts
from carnot.continuation import Continuation, continuation_of
from carnot.field import Field, field_of, labels_of
from carnot.flow import Flow, flow_of
from carnot.geodesic import Geodesic, Report, report_of
from carnot.progress import Progress, watched
from carnot.steering import Steering
from carnot.texts import Configuration, Integer, Limits, Real
from carnot.values import Array, numbers, row_pairs

VERIFICATIONS = np.array(["single", "knots", "grid", ""])


class Scene:
    """A system from a text in the language of docs/scene_language.md.

    >>> import carnot
    >>> skate = carnot.Scene('''
    ... coordinates x, y [length], theta [angle]
    ... kinetic = (x'^2 + y'^2 + theta'^2) / 2
    ... 0 = x' sin(theta) - y' cos(theta)
    ... ''')
    >>> skate.coordinates
    ('x', 'y', 'theta')
    >>> round(skate.geodesics([0, 0, 0], [0, 1, 0])[0].length, 6)
    3.340383

    `limits` are {"EXPRESSION": (lower, upper)}, None for a bound that is missing, or texts
    'EXPRESSION in A:B'; `discs` are (x, y, radius), which the named points of the body stay out of.
    `method` is a name of `methods`. Parameters are keywords, or in `parameters` where a name is one
    of those above. Scenes do not change; `replace` makes others. What is wrong is a ValueError, in
    the words of the program.
    """

    def __init__(
        self,
        text: str,
        *,
        name: str = "scene",
        limits: Limits = None,
        discs: Optional[Iterable[Any]] = None,
        method: Optional[str] = None,
        parameters: Optional[Mapping[str, Real]] = None,
        **more_parameters: Real,
    ) -> None:
        if not isinstance(text, str) or not text.strip():
            raise ValueError(
                f"text {text!r}: is no scene; accepted: a text in the language of scenes"
            )
        self._set(
            name,
            text,
            texts.parameter_texts(parameters, more_parameters),
            _method(method),
            texts.limit_texts(limits),
            texts.disc_texts(discs),
        )

    def _set(
        self,
        name: str,
        text: str,
        parameters: list[str],
        method: str,
        limits: list[str],
        discs: list[str],
    ) -> None:
        self._source = (name, text, parameters, method, limits, discs)
        self._model = _carnot.Model(*self._source)
        self._about: dict[str, Any] = json.loads(self._model.description())

    # ---- what it is

    @property
    def name(self) -> str:
        """What it is called."""
        return str(self._about["name"])

    @property
    def summary(self) -> str:
        """In one line."""
        return str(self._about["summary"])

    @property
    def kind(self) -> str:
        """Velocity constraints, optimal control, Lagrangian or generalized Hamiltonian."""
        return str(self._about["kind"])

    @property
    def text(self) -> str:
        """The scene in the language of scenes."""
        return str(self._model.text())

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the n coordinates."""
        return tuple(one["name"] for one in self._about["coordinates"])

    @property
    def units(self) -> tuple[str, ...]:
        """Those of the coordinates."""
        return tuple(one["unit"] for one in self._about["coordinates"])

    @property
    def periods(self) -> Array:
        """Those of the coordinates; 0 for one that has none."""
        return np.array([float(one["period"]) for one in self._about["coordinates"]])

    @property
    def multipliers(self) -> int:
        """The number k of multipliers."""
        return int(self._about["multipliers"])

    @property
    def parameters(self) -> dict[str, float]:
        """Values by name."""
        return {name: float(value) for name, value in self._about["values"].items()}

    @property
    def limits(self) -> tuple[str, ...]:
        """The names of the limits that geodesics keep to."""
        return tuple(self._about["limits"])

    @property
    def extremes(self) -> tuple[str, ...]:
        """Names of what is reported of every path."""
        return tuple(one["name"] for one in self._about["extremes"])

    @property
    def method(self) -> str:
        """The method of searches."""
        return str(self._about["method"])

    @property
    def methods(self) -> tuple[str, ...]:
        """The names of the methods that suit the scene."""
        return tuple(self._model.methods())

    def replace(
        self,
        *,
        limits: Limits = None,
        discs: Optional[Iterable[Any]] = None,
        method: Optional[str] = None,
        parameters: Optional[Mapping[str, Real]] = None,
        **more_parameters: Real,
    ) -> Scene:
        """The same scene with other parameters, method, limits or discs; the others stay.

        >>> import carnot
        >>> carnot.scene("vehicle").replace(length=2.5).parameters["length"]
        2.5
        """
        name, text, old, old_method, old_limits, old_discs = self._source
        new = texts.parameter_texts(parameters, more_parameters)
        names = {one.partition("=")[0] for one in new}
        kept = [one for one in old if one.partition("=")[0] not in names]
        return _scene_of(
            name,
            text,
            kept + new,
            old_method if method is None else _method(method),
            old_limits if limits is None else texts.limit_texts(limits),
            old_discs if discs is None else texts.disc_texts(discs),
        )

    # ---- geodesics

    def geodesics(
        self,
        start: Configuration,
        goal: Configuration,
        *,
        time: Real = 1,
        count: Optional[Integer] = None,
        all: bool = False,
        max_length: Optional[Real] = None,
        starts: Optional[Integer] = None,
        tolerance: Optional[Real] = None,
        minimiser: Optional[str] = None,
        mod_angles: bool = False,
        guess: Optional[Configuration] = None,
        time_limit: Optional[Real] = None,
        seed: Integer = 0,
        threads: Optional[Integer] = None,
        samples: Integer = 201,
        progress: Progress = None,
    ) -> Report:
        """Extremals that join two configurations, without a guess; least action first.

        >>> import carnot
        >>> heisenberg = carnot.scene("heisenberg-group")
        >>> report = heisenberg.geodesics([0, 0, 0], [0, 0, 1])
        >>> round(report[0].length**2, 10)  # 4 pi z
        12.5663706144

        A configuration has n numbers; None is a coordinate that is free. Options are those of
        `carnot geodesic`, but that 0 `samples` leave trajectories out. `progress` is a function of
        the fraction done, which stops the search where it returns False, or True for a bar. Ctrl-C
        raises KeyboardInterrupt within a few hundredths of a second.
        """
        options = texts.option_texts(
            {
                "time": time,
                "count": count,
                "max_length": max_length,
                "starts": starts,
                "tolerance": tolerance,
                "minimiser": minimiser,
                "time_limit": time_limit,
                "seed": seed,
                "threads": threads,
                "samples": samples,
            },
            all=all,
            mod_angles=mod_angles,
        )
        options["from"] = texts.vector_text("--from", start)
        options["to"] = texts.vector_text("--to", goal)
        if guess is not None:
            options["guess"] = texts.vector_text("--guess", guess)
        if options.get("samples") == "0":
            del options["samples"]
            options["no-trajectory"] = "1"
        with watched(progress) as tell:
            found, trajectories = self._model.geodesics(options, tell)
        return report_of(self, json.loads(found), trajectories)

    def follow(
        self,
        geodesic: Geodesic,
        *,
        to: Optional[Configuration] = None,
        start: Optional[Configuration] = None,
        time: Optional[Real] = None,
        limits: Limits = None,
        max_points: Optional[Integer] = None,
        tolerance: Optional[Real] = None,
        branches: bool = False,
        labels: bool = True,
        progress: Progress = None,
        **parameter: Real,
    ) -> Continuation:
        """Follows a geodesic while its goal, its start, the time, a limit or a parameter changes.

        Its ends are those that the geodesic has; none of their coordinates is free. `limits` is
        {"EXPRESSION": (lower, upper)} with one of the scene's limits and the bounds to end with.

        >>> import carnot
        >>> car = carnot.scene("vehicle")
        >>> curve = car.follow(car.geodesics([0, 0, 0, 0], [0, 1, 0, 0])[0], to=[0, 0.5, 0, 0])
        >>> curve.status
        'reached'
        """
        if not isinstance(geodesic, Geodesic):
            raise ValueError(f"geodesic {geodesic!r}: accepted: a geodesic, such as report[0]")
        ways = {
            "to": None if to is None else texts.vector_text("--along", to),
            "from": None if start is None else texts.vector_text("--along", start),
            "time": None if time is None else texts.number_text("--along time", time),
            **{
                name: texts.number_text(f"--along {name}", value)
                for name, value in parameter.items()
            },
        }
        for limit in texts.limit_texts(limits):
            name, bounds = limit.rsplit(" in ", 1)
            # A limit with one bound has the number alone.
            ways[f"limit:{name.strip()}"] = bounds.strip(" :")
        chosen = {name: value for name, value in ways.items() if value is not None}
        if len(chosen) != 1:
            raise ValueError(
                f"--along: {len(chosen)} things change; accepted: one of to, start, time, limits or "
                "a parameter"
            )
        options = texts.option_texts(
            {"max_points": max_points, "tolerance": tolerance},
            branches=branches,
            no_labels=not labels,
        )
        options["along"] = "=".join(next(iter(chosen.items())))
        options["time"] = repr(geodesic.time)
        options["from"] = texts.vector_text("--from", geodesic.start)
        options["to"] = texts.vector_text("--to", geodesic.goal)
        options["guess"] = texts.vector_text("--guess", geodesic.p0)
        with watched(progress) as tell:
            found = self._model.follow(options, tell)
        return continuation_of(self, json.loads(found))

    def solve_many(
        self,
        starts: npt.ArrayLike,
        goals: npt.ArrayLike,
        *,
        time: npt.ArrayLike = 1.0,
        free_goal: Union[str, Sequence[str]] = (),
        count: Optional[Integer] = None,
        max_length: Optional[Real] = None,
        search_starts: Optional[Integer] = None,
        tolerance: Optional[Real] = None,
        minimiser: Optional[str] = None,
        mod_angles: bool = False,
        time_limit: Optional[Real] = None,
        seed: Integer = 0,
        threads: Optional[Integer] = None,
        samples: Integer = 0,
        progress: Progress = None,
    ) -> npt.NDArray[np.void]:
        """Geodesics between many pairs, (N, n) and (N, n), on all cores.

        >>> import carnot, numpy
        >>> goals = numpy.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        >>> answers = carnot.scene("unicycle").solve_many(numpy.zeros((2, 3)), goals)
        >>> [float(round(length, 6)) for length in answers["length"]]
        [1.0, 3.340383]

        One of the two may be a single configuration. `time` is a number, or one for each. The
        answer is a structured array of shape (N,), or (N, count): "solved", "reason", "action",
        "length", "p0", "goal", "label", "morse_index", "error", "verification", "hits" and
        "seconds"; with `samples` also "q". Each row depends on its problem and the seed alone.
        `search_starts` is the option `starts` of `geodesics`.
        """
        rows = row_pairs(starts, goals)
        free = self._marked("free_goal", free_goal)
        options = texts.option_texts(
            {
                "count": 1 if count is None else count,
                "max_length": max_length,
                "starts": search_starts,
                "tolerance": tolerance,
                "minimiser": minimiser,
                "time_limit": time_limit,
                "seed": seed,
                "threads": threads,
                "trajectories": samples,
            },
            mod_angles=mod_angles,
        )
        times = np.atleast_1d(numbers("time", time))
        if not (np.isfinite(times) & (times > 0)).all():
            raise ValueError(f"time {time!r}: is not positive; accepted: finite numbers > 0")
        with watched(progress) as tell:
            found = self._model.solve_many(options, rows[0], rows[1], times, free, tell)
        answers = _answers(found, len(self.coordinates))
        return answers[:, 0] if options["count"] == "1" else answers

    def distance_field(
        self,
        grid: Mapping[str, npt.ArrayLike],
        *,
        start: Optional[Configuration] = None,
        goal: Optional[Configuration] = None,
        time: Real = 1,
        mod_angles: bool = False,
        check: Integer = 100,
        tolerance: Optional[Real] = None,
        seed: Integer = 0,
        threads: Optional[Integer] = None,
        progress: Progress = None,
    ) -> Field:
        """The least action to every point of a grid {coordinate: equidistant values}.

        Coordinates without an axis have the value of `goal`; both ends are zeros where nothing is
        said. `check` points are searched again with another seed. For scenes with velocity
        constraints or driftless controls, and without a potential.

        >>> import carnot, numpy
        >>> plane = numpy.linspace(-1, 1, 5)
        >>> field = carnot.scene("unicycle").distance_field({"x": plane, "y": plane}, check=0)
        >>> field.action.shape
        (5, 5)
        """
        n = len(self.coordinates)
        options = texts.option_texts(
            {
                "time": time,
                "check": check,
                "tolerance": tolerance,
                "seed": seed,
                "threads": threads,
            },
            mod_angles=mod_angles,
        )
        if not isinstance(grid, Mapping):
            raise ValueError(f"grid {grid!r}: accepted: {{coordinate: equidistant values}}")
        origin = ",".join("0" * n)
        options["from"] = origin if start is None else texts.vector_text("--from", start)
        options["to"] = origin if goal is None else texts.vector_text("--to", goal)
        axes = {name: numbers(f"grid {name}", values) for name, values in grid.items()}
        for name, values in axes.items():
            if name not in self.coordinates:
                raise ValueError(
                    f"grid {name!r}: no such coordinate; accepted: {', '.join(self.coordinates)}"
                )
            if values.ndim != 1:
                raise ValueError(f"grid {name}: {values.ndim} dimensions; accepted: one")
        listed = [(self.coordinates.index(name), list(axes[name])) for name in axes]
        with watched(progress) as tell:
            found = self._model.distance_field(options, listed, tell)
        begin = np.array([float(x) for x in _read(options["from"])])
        return field_of(self, begin, _read(options.get("time", "1"))[0], axes, found)

    def steering(
        self,
        *,
        time: Real = 1,
        mod_angles: bool = True,
        free_goal: Union[str, Sequence[str]] = (),
        starts: Optional[Integer] = None,
        tolerance: Optional[Real] = None,
        seed: Integer = 0,
        threads: Integer = 1,
        memory: Optional[Integer] = None,
    ) -> Steering:
        """Distances and paths for a planner; `memory` is how many answers are kept.

        >>> import carnot
        >>> steer = carnot.scene("unicycle").steering()
        >>> round(steer.distance([0, 0, 0], [0, 1, 0]), 6)
        3.340383
        >>> steer.steer([0, 0, 0], [0, 1, 0]).q.shape
        (101, 3)
        """
        options = texts.option_texts(
            {
                "time": time,
                "starts": starts,
                "tolerance": tolerance,
                "seed": seed,
                "threads": threads,
                "memory": memory,
            }
        )
        if not isinstance(mod_angles, (bool, np.bool_)):
            raise ValueError(f"--mod-angles {mod_angles!r}: is no flag; accepted: True, False")
        return Steering(self, options, bool(mod_angles), self._marked("free_goal", free_goal))

    # ---- flows

    def flow(
        self,
        q: Configuration,
        p: Optional[Configuration] = None,
        *,
        time: Real,
        velocity: Optional[Configuration] = None,
        multipliers: Optional[Configuration] = None,
        step: Optional[Real] = None,
        steps: Optional[Integer] = None,
        tolerance: Optional[Real] = None,
        method: Optional[str] = None,
        start_time: Real = 0,
        tangent: bool = False,
        samples: Integer = 201,
        progress: Progress = None,
    ) -> Flow:
        """Advances (q, p), or q with a velocity that satisfies the constraints.

        Exactly one of `step`, `steps` and `tolerance` is given; `tangent` asks for the derivative
        of the end by the start.

        >>> import carnot
        >>> run = carnot.scene("heisenberg").flow([0, 0, 0], [0.1, 0.3, 1], time=10, steps=100)
        >>> run.completed, run.q.shape, run.energy_drift < 1e-14
        (True, (201, 3), True)
        """
        scene = self if method is None else self.replace(method=method)
        options = texts.option_texts(
            {
                "time": time,
                "step": step,
                "steps": steps,
                "tolerance": tolerance,
                "start_time": start_time,
                "samples": samples,
            },
            tangent=tangent,
        )
        bare = options.get("samples") == "0"
        if bare:
            del options["samples"]
        options["from"] = texts.vector_text("--from", q)
        for name, value in (("momentum", p), ("velocity", velocity), ("lambda", multipliers)):
            if value is not None:
                options[name] = texts.vector_text(f"--{name}", value)
        with watched(progress) as tell:
            found, action, length, trajectory = scene._model.flow(options, tell)
        if bare:
            trajectory = {name: values[:0] for name, values in trajectory.items()}
        return flow_of(scene, json.loads(found), action, length, trajectory)

    def evaluate(
        self, q: npt.ArrayLike, p: npt.ArrayLike, t: float = 0.0
    ) -> tuple[float, Array, Array]:
        """The Hamiltonian, the velocity (n,) and the multipliers (k,) at a phase point.

        A ValueError says where the scene is not regular.

        >>> import carnot
        >>> energy, velocity, multipliers = carnot.scene("unicycle").evaluate([0, 0, 0], [2, 5, 1])
        >>> energy, velocity.tolist()
        (2.5, [2.0, 0.0, 1.0])
        """
        return self._model.evaluate(numbers("q", q), numbers("p", p), _real("t", t))

    def momentum(
        self,
        q: npt.ArrayLike,
        velocity: npt.ArrayLike,
        multipliers: Optional[npt.ArrayLike] = None,
        t: float = 0.0,
    ) -> Array:
        """p (n,) of a velocity, which is projected on the admissible ones first.

        >>> import carnot
        >>> carnot.scene("unicycle").momentum([0, 0, 0], [2, 0, 1], [5]).tolist()
        [2.0, 5.0, 1.0]
        """
        given = np.zeros(self.multipliers) if multipliers is None else multipliers
        return self._model.momentum(
            numbers("q", q),
            numbers("velocity", velocity),
            numbers("multipliers", given),
            _real("t", t),
        )[0]

    def verify(
        self, *, steps: Optional[Integer] = None, progress: Progress = None
    ) -> dict[str, Any]:
        """What the method keeps on this scene, as `carnot verify` measures it.

        "as_declared" says whether order, symplectic form, time reversal, energy and constraints are
        as the method declares; "steps" is the length of the long run.

        >>> import carnot
        >>> found = carnot.scene("heisenberg", method="gauss4").verify(steps=1000)
        >>> found["as_declared"], round(found["measured_order"])
        (True, 4)
        """
        text = "" if steps is None else texts.number_text("--steps", steps)
        with watched(progress) as tell:
            found: dict[str, Any] = json.loads(self._model.verify(text, tell))
        return found

    # ---- one's own formulas

    @staticmethod
    def from_sympy(q: Sequence[Any], **formulas: Any) -> Scene:
        """A scene from formulas of sympy; see `carnot.formulas.scene_of`.

        >>> import carnot, sympy
        >>> x, y, theta = sympy.symbols("x y theta", cls=sympy.Function)
        >>> t = sympy.Symbol("t")
        >>> v = [f(t).diff(t) for f in (x, y, theta)]
        >>> skate = carnot.Scene.from_sympy(
        ...     [x(t), y(t), theta(t)],
        ...     angles=[theta(t)],
        ...     kinetic=(v[0]**2 + v[1]**2 + v[2]**2) / 2,
        ...     constraints=[v[0] * sympy.sin(theta(t)) - v[1] * sympy.cos(theta(t))],
        ... )
        >>> round(skate.geodesics([0, 0, 0], [0, 1, 0])[0].length, 6)
        3.340383
        """
        from carnot import formulas as sympy_formulas

        return sympy_formulas.scene_of(q, **formulas)

    # ---- as a value

    def _marked(self, option: str, names: Union[str, Sequence[str]]) -> list[bool]:
        names = [names] if isinstance(names, str) else list(names or ())
        unknown = [name for name in names if name not in self.coordinates]
        if unknown:
            raise ValueError(
                f"{option} {unknown[0]!r}: no such coordinate; accepted: "
                f"{', '.join(self.coordinates)}"
            )
        return [name in names for name in self.coordinates] if names else []

    def __reduce__(self) -> Any:
        return _scene_of, self._source

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def _identity(self) -> tuple[Any, ...]:
        name, text, _, _, limits, discs = self._source
        methods = (self.method, self._about["flow_method"])
        return (name, text, tuple(self.parameters.items()), methods, tuple(limits), tuple(discs))

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:g}" for name, value in self.parameters.items())
        limits = "".join(f", {limit} limited" for limit in self.limits)
        names = ", ".join(self.coordinates)
        return f"<Scene {self.name}: {names}; {values or 'no parameters'}{limits}>"


def _scene_of(
    name: str,
    text: str,
    parameters: list[str],
    method: str,
    limits: list[str],
    discs: list[str],
) -> Scene:
    made = Scene.__new__(Scene)
    made._set(name, text, parameters, method, limits, discs)
    return made


def scenes() -> list[str]:
    """The names of the program's scenes.

    >>> import carnot
    >>> "vehicle" in carnot.scenes()
    True
    """
    return list(_carnot.scene_names())


def scene(
    name: str,
    *,
    limits: Limits = None,
    discs: Optional[Iterable[Any]] = None,
    method: Optional[str] = None,
    parameters: Optional[Mapping[str, Real]] = None,
    **more_parameters: Real,
) -> Scene:
    """A scene of the program, or of a file that ends in ".scene"; as Scene otherwise.

    >>> import carnot
    >>> carnot.scene("vehicle", length=2.8, limits={"phi - theta": (-0.6, 0.6)})
    <Scene vehicle: x, y, theta, phi; alpha = 1, beta = 1, length = 2.8, phi - theta limited>
    """
    text = ""
    if not isinstance(name, str):
        raise ValueError(f"SCENE {name!r}: is no name; accepted: one of scenes()")
    if _carnot.is_scene_file(name):
        name, text = _carnot.read_scene(name)
    return _scene_of(
        name,
        text,
        texts.parameter_texts(parameters, more_parameters),
        _method(method),
        texts.limit_texts(limits),
        texts.disc_texts(discs),
    )


def load(path: Union[str, os.PathLike[str]], **options: Any) -> Scene:
    """A scene from a file, whatever its name ends in; options are those of Scene.

    >>> import carnot, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "spring.scene")
    ...     _ = path.write_text("coordinates x\\nlagrangian = x'^2 / 2 - x^2 / 2\\n")
    ...     carnot.load(path)
    <Scene spring: x; no parameters>
    """
    name, text = _carnot.read_scene(os.fspath(path))
    return Scene(text, name=name, **options)


def _method(name: Optional[str]) -> str:
    if name is not None and not isinstance(name, str):
        raise ValueError(f"--method {name!r}: is no name; accepted: one of Scene.methods")
    return name or ""


def _real(name: str, value: Any) -> float:
    return float(_carnot.read_number(texts.number_text(name, value)))


def _read(text: str) -> list[float]:
    return [float(_carnot.read_number(one)) for one in text.split(",")]


def _answers(found: dict[str, Any], n: int) -> npt.NDArray[np.void]:
    rows, most = found["action"].shape
    fields: list[Any] = [
        ("solved", bool),
        ("reason", "U21"),
        ("action", float),
        ("length", float),
        ("p0", float, (n,)),
        ("goal", float, (n,)),
        ("label", "U16"),
        ("morse_index", float),
        ("error", float),
        ("verification", "U6"),
        ("hits", float),
        ("seconds", float),
    ]
    if "q" in found:
        fields.append(("q", float, found["q"].shape[2:]))
    answers = np.zeros((rows, most), dtype=fields)
    answers["solved"] = np.arange(most) < found["found"][:, None]
    answers["reason"] = np.array(found["reason"], dtype="U21").reshape(rows, 1)
    answers["seconds"] = found["seconds"][:, None]
    for name in ("action", "length", "p0", "morse_index", "hits"):
        answers[name] = found[name]
    answers["goal"] = found["to"]
    answers["label"] = labels_of(found["label"])
    codes = np.where(np.isnan(found["verification"]), len(VERIFICATIONS) - 1, found["verification"])
    answers["verification"] = VERIFICATIONS[codes.astype(int)]
    knots = np.isnan(found["endpoint_error"])
    answers["error"] = np.where(knots, found["knot_defect"], found["endpoint_error"])
    if "q" in found:
        answers["q"] = found["q"]
    return answers
