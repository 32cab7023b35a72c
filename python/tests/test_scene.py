import copy
import pickle

import numpy as np
import pytest

import carnot

SKATE = """# skate.scene: a skate
coordinates x, y [length], theta [angle]
parameters turning = 1 [length^2] > 0
kinetic = (x'^2 + y'^2 + turning theta'^2) / 2
0 = x' sin(theta) - y' cos(theta)
report heading [angle] = theta
"""


def test_describes_itself_as_the_program_does(answer):
    for name in ("vehicle", "bicycle", "rod-skate", "boat"):
        told = answer("scenes", name)["scenes"][0]
        scene = carnot.scene(name)
        assert scene.name == name
        assert scene.summary == told["summary"]
        assert scene.kind == told["kind"]
        assert list(scene.coordinates) == told["configuration"]
        assert scene.multipliers == told["multipliers"]
        assert list(scene.parameters) == [one["name"] for one in told["parameters"]]
        periods = dict(zip(scene.coordinates, scene.periods))
        assert {name: period for name, period in periods.items() if period > 0} == told["periods"]


def test_lists_the_scenes_of_the_program(answer):
    assert carnot.scenes() == [one["name"] for one in answer("scenes")["scenes"]]


def test_version_is_that_of_the_program(program):
    assert carnot.__version__ in program("--version").stdout


def test_text_scene_answers_like_the_compiled_one():
    text = carnot.Scene(SKATE).geodesics([0, 0, 0], [0, 1, 0]).best()
    compiled = carnot.scene("unicycle").geodesics([0, 0, 0], [0, 1, 0]).best()
    assert text.action == pytest.approx(compiled.action, rel=1e-13)  # a few hundred roundings
    assert text.extremes["largest_heading"] > 0


def test_reads_files(tmp_path, refusal):
    path = tmp_path / "skate.scene"
    path.write_text(SKATE)
    assert carnot.load(path) == carnot.scene(str(path)) == carnot.Scene(SKATE, name="skate")
    path.write_text(SKATE + "let a = b\n")  # files are read anew
    with pytest.raises(ValueError, match="skate.scene:7:9"):
        carnot.load(path)
    with pytest.raises(ValueError, match="can't be read"):
        carnot.load(tmp_path / "none.scene")
    with pytest.raises(ValueError) as error:
        carnot.scene(str(path))
    assert str(error.value) == refusal("scenes", str(path))


def test_parameters_are_set_and_replaced():
    car = carnot.scene("vehicle", length=2.8, parameters={"alpha": "2pi"})
    assert car.parameters == {"alpha": 2 * np.pi, "beta": 1.0, "length": 2.8}
    other = car.replace(length=1, beta=3)
    assert other.parameters == {"alpha": 2 * np.pi, "beta": 3.0, "length": 1.0}
    assert car.parameters["length"] == 2.8
    limited = other.replace(limits={"phi - theta": (-0.6, None)}, method="gauss8")
    assert limited.limits == ("phi - theta",)
    assert limited.method == "gauss8"
    assert limited.parameters == other.parameters
    assert limited.replace(limits={}).limits == ()


@pytest.mark.parametrize(
    "make, arguments",
    [
        (lambda: carnot.scene("vehicl"), ["scenes", "vehicl"]),
        (
            lambda: carnot.scene("vehicle", length=-1),
            ["geodesic", "vehicle", "--set", "length=-1"],
        ),
        (
            lambda: carnot.scene("vehicle", lenght=1),
            ["geodesic", "vehicle", "--set", "lenght=1"],
        ),
        (
            lambda: carnot.scene("vehicle", length=float("nan")),
            ["geodesic", "vehicle", "--set", "length=nan"],
        ),
        (
            lambda: carnot.scene("vehicle", method="gaus16"),
            ["geodesic", "vehicle", "--method", "gaus16"],
        ),
        (
            lambda: carnot.scene("vehicle", limits=["phi - thet in 0:1"]),
            "geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --limit".split() + ["phi - thet in 0:1"],
        ),
        (
            lambda: carnot.scene("vehicle", discs=[(0, 1, -1)]),
            "geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --disc 0,1,-1".split(),
        ),
    ],
)
def test_refuses_in_the_words_of_the_program(make, arguments, refusal):
    with pytest.raises(ValueError) as error:
        make()
    assert str(error.value) == refusal(*arguments)


def test_refuses_what_is_no_number_or_no_pair():
    for bad in ([1], None, True, 1j, "one"):
        with pytest.raises(ValueError, match="length"):
            carnot.scene("vehicle", length=bad)
    with pytest.raises(ValueError, match="no pair"):
        carnot.scene("vehicle", limits={"phi": 1})
    for bad in ("  \n", None, 3):
        with pytest.raises(ValueError, match="is no scene"):
            carnot.Scene(bad)
    with pytest.raises(ValueError, match="is no name"):
        carnot.scene(None)
    for name, bad in (("limits", 3), ("discs", 3), ("discs", (1, 2, 3)), ("parameters", 3)):
        with pytest.raises(ValueError, match="accepted"):
            carnot.scene("vehicle", **{name: bad})
    with pytest.raises(ValueError, match="--method"):
        carnot.scene("vehicle", method=3)


def test_obstacles_in_an_array():
    discs = np.array([[3, 3, 0.1], [4, 4, 0.1]])
    assert carnot.scene("vehicle", discs=discs).limits == carnot.scene(
        "vehicle", discs=[(3, 3, 0.1), (4, 4, 0.1)]
    ).limits


def test_words_with_any_letters():
    with pytest.raises(ValueError, match="scene:1:13"):
        carnot.Scene("coordinates é")
    with pytest.raises(ValueError, match="--limit"):
        carnot.scene("vehicle", limits={"phi - θ": (-1, 1)})


def test_is_a_value():
    for scene in (
        carnot.scene("vehicle", length=2, limits={"phi - theta": (-0.6, 0.6)}, discs=[(1, 2, 0.1)]),
        carnot.Scene(SKATE, turning=2),
    ):
        for twin in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
            assert twin == scene
            assert hash(twin) == hash(scene)
            assert twin.parameters == scene.parameters
            assert twin.limits == scene.limits
        assert scene != scene.replace(method="gauss8")
        assert scene != 1
    assert "skate" in repr(carnot.Scene(SKATE, name="skate"))
