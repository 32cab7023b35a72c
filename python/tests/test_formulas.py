import pytest
import sympy

import carnot

t = sympy.Symbol("t")
x, y, theta, phi = (sympy.Function(name)(t) for name in ("x", "y", "theta", "phi"))
vx, vy, vtheta, vphi = (q.diff(t) for q in (x, y, theta, phi))


def test_the_vehicle_is_the_program_s(car):
    length = sympy.Symbol("length")
    mine = carnot.Scene.from_sympy(
        [x, y, theta, phi],
        kinetic=(vx**2 + vy**2 + vtheta**2 + vphi**2) / 2,
        constraints=[
            vx * sympy.sin(phi) - vy * sympy.cos(phi),
            sympy.Eq(vx * sympy.sin(theta) + length * vtheta, vy * sympy.cos(theta)),
        ],
        parameters={length: 2.5},
        angles=[theta, phi],
        units={x: "length", y: "length"},
        name="mine",
    )
    assert mine.name == "mine"
    assert mine.units == ("length", "length", "rad", "rad")
    assert mine.parameters == {"length": 2.5}
    theirs = car.replace(length=2.5).geodesics([0, 0, 0, 0], [0, 1, 0, 0]).best()
    best = mine.geodesics([0, 0, 0, 0], [0, 1, 0, 0]).best()
    assert best.action == pytest.approx(theirs.action, rel=1e-11)


def test_symbols_with_velocities_and_limits(unicycle):
    a, b, c, u, v, w = sympy.symbols("a b c u v w")
    mine = carnot.Scene.from_sympy(
        [a, b, c],
        velocities=[u, v, w],
        kinetic=(u**2 + v**2 + w**2) / 2,
        constraints=[u * sympy.sin(c) - v * sympy.cos(c)],
        angles=[c],
        limits={"c": (-0.5, 0.5)},
    )
    limited = unicycle.replace(limits={"theta": (-0.5, 0.5)})
    mine_best = mine.geodesics([0, 0, 0], [0, 0.3, 0]).best()
    assert mine_best.action == pytest.approx(
        limited.geodesics([0, 0, 0], [0, 0.3, 0]).best().action, rel=1e-9
    )


def test_controls_and_cost():
    u, w = sympy.symbols("u w")
    mine = carnot.Scene.from_sympy(
        [x, y, theta],
        controls=[u, w],
        rates=[u * sympy.cos(theta), u * sympy.sin(theta), w],
        cost=u**2 / 2 + w**2 / 2,
        angles=[theta],
    )
    theirs = carnot.scene("unicycle").geodesics([0, 0, 0], [0, 1, 0]).best()
    best = mine.geodesics([0, 0, 0], [0, 1, 0]).best()
    assert best.action == pytest.approx(theirs.action, rel=1e-11)


@pytest.mark.parametrize(
    "formula",
    [
        sympy.sqrt(1 + x**2),
        1 / (2 + sympy.cos(x)),
        sympy.exp(-x) + sympy.E * x,
        sympy.Rational(1, 3) * x**2 - sympy.pi * x,
        sympy.Float("0.1") * x**3,
        (1 + x**2) ** sympy.Rational(-3, 2),
        sympy.atan2(x, 2) + sympy.tanh(x) * sympy.log(2 + x**2),
        -(x**2) + 2 ** (x / 3),
        sympy.cos(x) * (x - 1) ** 4 / 7,
        sympy.sin(t) * x,
        sympy.sec(x / 4) + sympy.cot(1 + x / 4) - sympy.csc(1 + x / 4) * sympy.sech(x),
    ],
)
def test_formulas_keep_their_values(formula):
    """The Hamiltonian of a particle in a potential, at some points."""
    scene = carnot.Scene.from_sympy([x], lagrangian=vx**2 / 2 - formula)
    value = sympy.lambdify((x, t), formula, "math")
    for q, time in ((0.3, 0.0), (-0.7, 1.5), (1.9, -2.0)):
        energy, _, _ = scene.evaluate([q], [0.5], time)
        assert energy == pytest.approx(0.125 + value(q, time), rel=1e-14, abs=1e-14)


def test_what_people_write(unicycle):
    """Matrices, equations, functions as controls, one constraint alone, symbols as limits."""
    u, w = (sympy.Function(name)(t) for name in ("u", "w"))
    v = sympy.Matrix([vx, vy, vtheta])
    skates = [
        carnot.Scene.from_sympy(
            [x, y, theta],
            kinetic=v.T * v / 2,
            constraints=vx * sympy.tan(theta) * sympy.sec(sympy.Integer(0)) - vy,
            angles=[theta],
            limits={theta: (-0.5, 0.5)},
        ),
        carnot.Scene.from_sympy(
            [x, y, theta],
            controls=[u, w],
            rates=[
                sympy.Eq(vx, u * sympy.cos(theta)),
                sympy.Eq(vy, u * sympy.sin(theta)),
                sympy.Eq(vtheta, w),
            ],
            cost=(u**2 + w**2) / 2,
            angles=[theta],
            limits={theta: (-0.5, 0.5)},
        ),
    ]
    limited = unicycle.replace(limits={"theta": (-0.5, 0.5)})
    action = limited.geodesics([0, 0, 0], [0, 0.3, 0]).best().action
    for skate in skates:
        best = skate.geodesics([0, 0, 0], [0, 0.3, 0]).best()
        assert best.action == pytest.approx(action, rel=1e-8)


@pytest.mark.parametrize(
    "q, formulas, what",
    [
        ("xy", {}, "symbols"),
        (["x"], {}, "symbols"),
        ([], {}, "at least one"),
        ([x, x], {"kinetic": vx**2}, "twice"),
        ([x], {"kinetic": sympy.eye(2)}, "a matrix"),
        ([x], {"controls": [y], "rates": [y, y], "cost": y**2}, "one for each"),
        ([x], {"kinetic": vx**2, "parameters": {sympy.Symbol("k"): None}}, "k None"),
    ],
)
def test_refuses_formulas(q, formulas, what):
    with pytest.raises(ValueError, match=what):
        carnot.Scene.from_sympy(q, **formulas)


def test_refuses_what_the_language_has_no_word_for():
    for bad in (sympy.Abs(x), sympy.gamma(x), vx.diff(t), sympy.EulerGamma * x):
        with pytest.raises(ValueError, match="accepted"):
            carnot.Scene.from_sympy([x], lagrangian=vx**2 / 2 - bad)
    with pytest.raises(ValueError, match="no coordinate"):
        carnot.Scene.from_sympy([x], lagrangian=vx**2 / 2, angles=[y])
    with pytest.raises(ValueError, match="velocities"):
        carnot.Scene.from_sympy(sympy.symbols("a b"), velocities=[vx], lagrangian=vx**2)
    with pytest.raises(ValueError, match="one time"):
        other = sympy.Function("y")(sympy.Symbol("s"))
        carnot.Scene.from_sympy([x, other], lagrangian=vx**2)
    with pytest.raises(ValueError, match="k"):
        carnot.Scene.from_sympy([x], lagrangian=vx**2 / 2 - sympy.Symbol("k") * x**2)
