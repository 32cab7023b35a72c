import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import carnot

TARGETS = np.random.default_rng(5).uniform(-1, 1, (12, 3))
EXACT = [
    "solved", "reason", "action", "length", "p0", "goal", "label", "morse_index", "error",
    "verification", "hits",
]  # fmt: skip


def without_seconds(answers):
    return [answers[name].tolist() for name in EXACT]


def test_each_is_that_of_geodesics(unicycle):
    answers = unicycle.solve_many(np.zeros(3), TARGETS, samples=11)
    for target, one in zip(TARGETS, answers):
        best = unicycle.geodesics([0, 0, 0], target, samples=11).best()
        assert one["action"] == best.action
        assert one["p0"].tolist() == best.p0.tolist()
        assert one["q"].tolist() == best.q.tolist()
        assert one["label"] == best.label
        assert one["error"] == best.error


def test_does_not_depend_on_threads_order_or_others(unicycle):
    answers = unicycle.solve_many(np.zeros(3), TARGETS, threads=1)
    two = unicycle.solve_many(np.zeros(3), TARGETS, threads=2)
    back = unicycle.solve_many(np.zeros(3), TARGETS[::-1])[::-1]
    few = unicycle.solve_many(np.zeros(3), TARGETS[:3])
    assert without_seconds(answers) == without_seconds(two) == without_seconds(back)
    assert without_seconds(answers[:3]) == without_seconds(few)


def test_takes_arrays_of_every_kind(unicycle):
    exact = np.round(TARGETS[:4] * 4) / 4  # the same in single precision
    plain = without_seconds(unicycle.solve_many(np.zeros((4, 3)), exact))
    wide = np.zeros((8, 6))
    wide[::2, ::2] = exact
    frozen = exact.copy()
    frozen.flags.writeable = False
    for goals in (
        exact.tolist(),
        np.asfortranarray(exact),
        wide[::2, ::2],
        frozen,
        exact.astype(np.float32),
        exact.astype(">f8"),
    ):
        assert without_seconds(unicycle.solve_many(np.zeros((4, 3)), goals)) == plain
    whole = np.array([[1, 2, 0]])
    assert unicycle.solve_many(whole * 0, whole)["solved"].all()


def test_several_geodesics_of_each(unicycle):
    answers = unicycle.solve_many(np.zeros(3), TARGETS[:3], count=3)
    assert answers.shape == (3, 3)
    found = answers["solved"]
    assert (np.diff(answers["action"], axis=1)[found[:, 1:]] >= 0).all()
    assert found.sum() > 5
    assert np.isnan(answers["action"][~found]).all()
    far = unicycle.solve_many(np.zeros(3), [[1, 0, 0], [0, 1, 0]], max_length=2)
    assert far["solved"].tolist() == [True, False]
    assert far["reason"].tolist() == ["none", "too-long"]
    assert np.isnan(far["action"][1])
    assert far["label"][1] == ""


def test_times_and_free_coordinates(unicycle):
    twice = unicycle.solve_many(np.zeros(3), TARGETS[:2], time=[1, 2])
    once = unicycle.solve_many(np.zeros(3), TARGETS[:2])
    assert twice["action"] == pytest.approx(once["action"] / [1, 2], rel=1e-9)
    free = unicycle.solve_many(np.zeros(3), TARGETS, free_goal=["theta"])
    assert (free["action"] <= unicycle.solve_many(np.zeros(3), TARGETS)["action"]).all()
    assert np.abs(free["goal"][:, :2] - TARGETS[:, :2]).max() == 0


def test_limits_hold(unicycle):
    limited = unicycle.replace(limits={"theta": (-0.5, 0.5)})
    answers = limited.solve_many(np.zeros(3), [[0, 0.3, 0], [0, 0, 1]], samples=201)
    assert np.abs(answers["q"][0, :, 2]).max() < 0.5 + 1e-9
    assert answers["reason"][1] == "limit-at-end"


def test_one_that_is_refused_does_not_stop_the_others():
    ball = carnot.scene("plate-ball")
    goals = [[1, 0, 0, np.pi / 2, 0], [0.5, 0, 0, 0, 0.1]]
    answers = ball.solve_many(np.zeros(5), goals)
    assert answers["reason"][0] == "irregular-end"
    assert answers["solved"].tolist() == [False, True]


def test_none_at_all(unicycle):
    assert unicycle.solve_many(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)
    assert unicycle.solve_many(np.zeros(3), np.zeros((0, 3))).shape == (0,)


@pytest.mark.parametrize(
    "starts, goals, options, what",
    [
        (np.zeros((2, 3)), np.zeros((3, 3)), {}, "as many"),
        (np.zeros((2, 4)), np.zeros((2, 4)), {}, "rows of 3"),
        (np.zeros((2, 3)), np.full((2, 3), np.nan), {}, "holds nan"),
        (np.zeros((2, 3)), np.full((2, 3), np.inf), {}, "holds inf"),
        (np.zeros((2, 3), complex), np.zeros((2, 3)), {}, "complex"),
        (np.zeros((2, 3), bool), np.zeros((2, 3)), {}, "bool"),
        (np.zeros((2, 3)), [["a", "b", "c"]] * 2, {}, "real numbers"),
        (np.zeros((2, 3)), np.zeros((2, 3), object), {}, "real numbers"),
        (np.zeros((1, 2, 3)), np.zeros((1, 2, 3)), {}, "rows of 3"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"time": [1, 2, 3]}, "time"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"time": [1, -1]}, "time"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"time": np.nan}, "time"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"count": 0}, "--count"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"count": True}, "--count"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"samples": 1}, "--trajectories"),
        (np.zeros((2, 3)), np.ones((2, 3)), {"free_goal": ["z"]}, "no such coordinate"),
    ],
)
def test_refuses(starts, goals, options, what, unicycle):
    with pytest.raises(ValueError, match=what):
        unicycle.solve_many(starts, goals, **options)


@settings(max_examples=40, deadline=None)
@given(
    goal=st.lists(
        st.one_of(st.floats(), st.integers(), st.none(), st.text(max_size=4), st.booleans()),
        max_size=4,
    )
)
def test_any_goal_is_solved_or_refused(goal):
    try:
        report = carnot.scene("grushin").geodesics([0.5, 0], goal, starts=4, time_limit=0.2)
    except ValueError:
        return
    assert report.status in ("converged", "not_converged")
    assert bool(report) == (report.reason == "none")


@settings(max_examples=60, deadline=None)
@given(
    array=hnp.arrays(
        dtype=st.sampled_from([np.float64, np.float32, np.int32, np.complex128, "U2"]),
        shape=hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
    )
)
def test_any_array_is_solved_or_refused(array):
    scene = carnot.scene("grushin")
    try:
        answers = scene.solve_many(np.zeros(2), array, search_starts=4, time_limit=0.2)
    except ValueError:
        return
    assert answers.shape == (len(np.atleast_2d(array)),)
    assert np.isfinite(answers["action"][answers["solved"]]).all()
