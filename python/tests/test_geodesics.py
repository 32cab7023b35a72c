import copy
import math
import pickle

import numpy as np
import pytest

import carnot

KEYS = ("action", "constraint_error", "energy_drift", "label", "morse_index", "hits", "abnormal")


def same_as_program(scene, report, told):
    """To the last bit, but for the seconds."""
    assert len(report) == len(told["geodesics"])
    assert (report.starts, report.converged_starts) == (told["starts"], told["converged_starts"])
    assert report.missed_estimate == told["missed_estimate"]
    for mine, theirs in zip(report, told["geodesics"]):
        for key in KEYS:
            assert getattr(mine, key) == theirs[key], key
        assert mine.length == theirs["length"]
        assert mine.verification == theirs["verification"]
        assert mine.p0.tolist() == theirs["p0"]
        assert mine.lambda0.tolist() == theirs["lambda0"]
        if theirs["conjugate_times"] is None:
            assert mine.conjugate_times is None
        else:
            assert mine.conjugate_times.tolist() == theirs["conjugate_times"]
        for name in scene.extremes:
            assert mine.extremes[name] == theirs[name]
        for name in ("t", "q", "p", "hamiltonian"):
            assert getattr(mine, name).tolist() == theirs["trajectory"][name], name
        assert mine.multipliers.tolist() == theirs["trajectory"]["lambda"]


@pytest.mark.parametrize(
    "name, start, goal, options, arguments",
    [
        ("vehicle", "0,0,0,0", "0,1,0,0", {"count": 2}, ["--count", "2"]),
        ("unicycle", "0,0,0", "1,1,3", {"mod_angles": True}, ["--mod-angles"]),
        ("heisenberg-group", "0,0,0", "1,0,0.2", {"all": True}, ["--all"]),
        ("bicycle", "0,0,0,0", "1,1,0,0", {"seed": 3}, ["--seed", "3"]),
        ("martinet", "0,0,0", "1,1,0.1", {"minimiser": "ceres"}, ["--minimiser", "ceres"]),
        ("rod-skate", "0,0,1,0", "0.5,0,1.5,0", {"time": 0.5}, ["--time", "0.5"]),
        ("kapitza-pendulum", "0", "1", {}, []),
    ],
)
def test_is_that_of_the_program_to_the_last_bit(name, start, goal, options, arguments, answer):
    scene = carnot.scene(name)
    ends = ([float(x) for x in end.split(",")] for end in (start, goal))
    report = scene.geodesics(*ends, **options)
    told = answer("geodesic", name, "--from", start, "--to", goal, *arguments)
    assert report.status == told["status"]
    same_as_program(scene, report, told)


def test_limits_are_those_of_the_program(answer):
    car = carnot.scene("vehicle", limits={"phi - theta": (-0.3, 0.3)})
    report = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0])
    arguments = "geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --limit".split()
    told = answer(*arguments, "phi - theta in -0.3:0.3")
    same_as_program(car, report, told)
    [limit] = report[0].limits
    [theirs] = told["geodesics"][0]["limits"]
    assert limit.lowest_slack == theirs["lowest_slack"]
    assert [list(arc) for arc in limit.active] == theirs["active"]
    assert report[0].action == pytest.approx(23.275244006, abs=1e-8)
    assert "slack" in repr(report)


def test_free_coordinates_are_found(car):
    fixed = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0]).best()
    free = car.geodesics([0, 0, 0, 0], [0, 1, 0, None]).best()
    assert free.action < fixed.action
    assert free.goal[3] == pytest.approx(free.q[-1, 3], abs=1e-10)
    assert free.transversality_error < 1e-10
    assert car.geodesics("0,0,0,0", "0,1,0,*").best() == free


def test_windings_are_in_the_goal(unicycle):
    best = unicycle.geodesics([0, 0, 0], [1, 0, 6.2], mod_angles=True).best()
    assert best.windings == (0, 0, -1)
    assert best.q[-1] == pytest.approx(best.goal, abs=1e-9)
    assert best.goal[2] == pytest.approx(6.2 - 2 * math.pi)


def test_arrays_have_the_shapes_that_are_said(parking):
    best = parking.best()
    assert best.q.shape == best.p.shape == (201, 4)
    assert best.multipliers.shape == (201, 2)
    assert best.t.shape == best.hamiltonian.shape == (201,)
    assert best.t[[0, -1]].tolist() == [0, 1]
    assert best.q.flags.c_contiguous
    assert best.q[-1] == pytest.approx(best.goal, abs=1e-10)
    assert all(g.q.dtype == np.float64 for g in parking)


def test_without_samples(car, parking):
    bare = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0], samples=0).best()
    assert bare.q.shape == bare.p.shape == (0, 4)
    assert bare.t.shape == (0,)
    assert bare.p0.tolist() == parking.best().p0.tolist()


def test_report_is_a_sequence_and_prints(parking):
    assert len(parking) == 2
    assert parking
    assert parking[0] is parking.best()
    assert list(parking)[1] is parking[-1]
    assert parking[:1] == parking.geodesics[:1]
    assert "22.7078818" in repr(parking)
    page = parking._repr_html_()
    assert page.count("<tr>") == 3
    assert "largest steering angle" in page
    assert "22.7" in repr(parking[0])


def test_nothing_found_is_false_and_says_why(car):
    report = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0], max_length=1)
    assert not report
    assert (report.status, report.reason) == ("not_converged", "too-long")
    assert "--max-length" in report.message
    assert report.message in repr(report)
    assert report.message in report._repr_html_()
    with pytest.raises(carnot.NotConverged, match="--max-length"):
        report.best()
    assert pickle.loads(pickle.dumps(report)) == report


def test_reports_and_geodesics_are_values(parking):
    for value in (parking, parking[0]):
        assert pickle.loads(pickle.dumps(value)) == value
        assert copy.deepcopy(value) == value
        assert value != 1
        with pytest.raises(TypeError):
            hash(value)
        with pytest.raises(AttributeError):
            value.label = "mine"
    assert parking[0] != parking[1]


@pytest.mark.parametrize(
    "start, goal, options",
    [
        ([0, 0, 0], [0, 1, 0, 0], {}),
        ([0, 0, 0, 0], [0, 1, 0, math.nan], {}),
        ([0, 0, 0, 0], [0, 1, 0, math.inf], {}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"count": 0}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"count": 2.5}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"time": -1}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"time_limit": 0}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"tolerance": 2}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"minimiser": "nloptt"}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"samples": 1}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"threads": 0}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"seed": -1}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"starts": 0}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"count": 2, "all": True}),
        ([0, 0, 0, 0], [0, 1, 0, 0], {"guess": [1, 2]}),
    ],
)
def test_refuses_in_the_words_of_the_program(start, goal, options, car, refusal):
    with pytest.raises(ValueError) as error:
        car.geodesics(start, goal, **options)
    texts = [",".join(repr(x) for x in end) for end in (start, goal)]
    arguments = ["geodesic", "vehicle", "--from", texts[0], "--to", texts[1]]
    for name, value in options.items():
        text = ",".join(map(str, value)) if isinstance(value, list) else str(value)
        arguments.append("--" + name.replace("_", "-"))
        if value is not True:
            arguments.append(text)
    mine, theirs = str(error.value), refusal(*arguments)
    # 0 and 0.0, -1 and -1.0: numbers are passed on as Python writes them.
    assert mine.replace(".0'", "'") == theirs


@pytest.mark.parametrize(
    "bad",
    [
        [[0, 0, 0, 0]],
        3,
        b"0123",
        {0, 1, 2, 3},
        None,
        np.array(1),
        [0, 0, 0, 1j],
        [0, 0, 0, [1]],
        [0, 0, 0, True],
    ],
)
def test_refuses_what_is_no_row_of_numbers(bad, car):
    with pytest.raises(ValueError, match="--to"):
        car.geodesics([0, 0, 0, 0], bad)


@pytest.mark.parametrize(
    "options",
    [{"all": "no"}, {"count": True}, {"samples": False}, {"mod_angles": 1}, {"progress": 3}],
)
def test_refuses_options_of_another_type(options, car):
    with pytest.raises(ValueError, match=f"{next(iter(options)).replace('_', '-')}"):
        car.geodesics([0, 0, 0, 0], [0, 1, 0, 0], **options)


def test_the_same_search_twice_is_equal(car, parking):
    again = car.geodesics(np.zeros(4), [0, 1, 0, 0], count=2)
    assert again == parking
    assert again.elapsed_seconds != parking.elapsed_seconds
    assert carnot.scene("vehicle", **car.parameters) == car


def test_takes_numbers_of_every_kind(car, parking):
    best = parking.best()
    goals = [
        (0, 1, 0, 0),
        "0,1,0,0",
        ["0", "1", "0*pi", 0],
        np.array([0, 1, 0, 0]),
        np.array([0, 1, 0, 0], dtype=np.float32),
        np.array([0, 9, 1, 9, 0, 9, 0, 9.0])[::2],
    ]
    frozen = np.array([0.0, 1, 0, 0])
    frozen.flags.writeable = False
    for goal in [*goals, frozen]:
        assert car.geodesics(np.zeros(4), goal, count=2).best() == best
