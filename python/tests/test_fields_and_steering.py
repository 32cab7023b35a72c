import copy
import math
import pickle
import threading

import numpy as np
import pytest

import carnot


@pytest.fixture(scope="module")
def field(unicycle):
    plane = np.linspace(-2, 2, 9)
    heading = np.linspace(-np.pi, np.pi, 9)[:-1]
    return unicycle.distance_field({"x": plane, "y": plane, "theta": heading}, mod_angles=True)


def test_field_holds_what_searches_find(field, unicycle):
    assert field.finished
    assert field.lower == 0
    assert field.settled
    assert field.triangles > 0
    assert field.violations == 0
    assert field.action.shape == (9, 9, 8)
    assert field.p0.shape == (9, 9, 8, 3)
    assert (field.reason == "none").all()
    for index in [(0, 0, 0), (4, 8, 4), (7, 2, 5)]:
        goal = [axis[i] for axis, i in zip(field.axes.values(), index)]
        best = unicycle.geodesics([0, 0, 0], goal, mod_angles=True).best()
        assert field.action[index] == pytest.approx(best.action, rel=1e-8)
        assert field.distance[index] == pytest.approx(best.length, rel=1e-8)


def test_field_is_the_same_on_any_number_of_threads(unicycle):
    grid = {"x": np.linspace(-1, 1, 5), "y": np.linspace(-1, 1, 5)}
    one = unicycle.distance_field(grid, threads=1, check=3)
    two = unicycle.distance_field(grid, threads=2, check=3)
    assert one.action.tolist() == two.action.tolist()
    assert one.p0.tolist() == two.p0.tolist()


def test_field_is_a_value(field):
    assert pickle.loads(pickle.dumps(field)) == field
    assert copy.deepcopy(field) == field
    assert "9" in repr(field)


def test_the_same_field_twice_is_equal(unicycle):
    grid = {"x": [0, 1], "y": [0, 1]}
    assert unicycle.distance_field(grid, time=None) == unicycle.distance_field(grid)


@pytest.mark.parametrize(
    "grid, what",
    [
        (None, "grid"),
        ({"z": [0, 1]}, "no such coordinate"),
        ({"x": [[0, 1]]}, "grid x"),
        ({"x": [0, 1, 3]}, "equidistant"),
        ({"x": []}, "values"),
        ({"x": [0, math.nan]}, "x"),
        ({}, "ax"),
    ],
)
def test_field_refuses(grid, what, unicycle):
    with pytest.raises(ValueError, match=what):
        unicycle.distance_field(grid)


def test_field_refuses_scenes_with_drift():
    with pytest.raises(ValueError):
        carnot.scene("kapitza-pendulum").distance_field({"theta": [0, 1]})


@pytest.fixture(scope="module")
def steer(unicycle):
    return unicycle.steering()


def test_steering_is_the_geodesic(steer, unicycle):
    way = steer.steer([0, 0, 0], [0, 1, 0])
    best = unicycle.geodesics([0, 0, 0], [0, 1, 0], samples=101).best()
    assert way
    assert way.distance == pytest.approx(best.length, rel=1e-9)
    assert way.q.shape == (101, 3)
    assert way.q[[0, -1]].tolist() == [[0, 0, 0], [0, 1, 0]]


def test_distances_of_rows(steer):
    goals = np.random.default_rng(1).uniform(-1, 1, (6, 3))
    all_at_once = steer.distances(np.zeros(3), goals, threads=2)
    assert all_at_once.tolist() == [steer.distance([0, 0, 0], goal) for goal in goals]
    assert steer.symmetric
    assert steer.distances(goals, np.zeros(3)).tolist() == all_at_once.tolist()
    assert isinstance(steer.distance([0, 0, 0], [1, 0, 0]), float)


def test_alternatives_are_in_order(steer):
    ways = steer.alternatives([0, 0, 0], [0, 1, 0], 3)
    # Mirror images have the same action, and lengths that differ by round-off.
    round_off = 4 * np.finfo(float).eps
    distances = [way.distance for way in ways]
    for less, more in zip(distances, distances[1:]):
        assert more >= less * (1 - round_off)
    assert copy.deepcopy(ways) == ways


def test_steering_from_many_threads(unicycle):
    shared = unicycle.steering()
    goals = np.random.default_rng(2).uniform(-1, 1, (8, 3))
    found = [None] * 4

    def ask(i):
        found[i] = shared.distances(np.zeros(3), goals, threads=1).tolist()

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found.count(found[0]) == 4


def test_steering_pickles(steer):
    twin = pickle.loads(pickle.dumps(steer))
    assert twin == steer
    assert twin.distance([0, 0, 0], [1, 1, 1]) == steer.distance([0, 0, 0], [1, 1, 1])
    assert copy.deepcopy(steer) == steer


def test_steering_refuses(steer, unicycle):
    with pytest.raises(ValueError):
        steer.distance([0, 0], [1, 1])
    with pytest.raises(ValueError):
        steer.steer([0, 0, math.nan], [1, 1, 1])
    for samples in (1, 2.0, 10**9, None):
        with pytest.raises(ValueError, match="samples"):
            steer.steer([0, 0, 0], [1, 1, 1], samples=samples)
    with pytest.raises(ValueError, match="distances"):
        steer.distance([0, 0, 0], [[1, 1, 1]])
    with pytest.raises(ValueError, match="--threads"):
        steer.distances([0, 0, 0], [1, 1, 1], threads=0)
    with pytest.raises(ValueError, match="--mod-angles"):
        unicycle.steering(mod_angles="no")
    with pytest.raises(ValueError):
        steer.alternatives([0, 0, 0], [1, 1, 1], 0)
    with pytest.raises(ValueError, match="limits"):
        unicycle.replace(limits={"theta": (-1, 1)}).steering()
    with pytest.raises(ValueError, match="no such coordinate"):
        unicycle.steering(free_goal=["phi"])


def test_free_headings_are_never_longer(steer, unicycle):
    free = unicycle.steering(free_goal=["theta"])
    goals = np.random.default_rng(3).uniform(-1, 1, (5, 3))
    shorter = steer.distances(np.zeros(3), goals) - free.distances(np.zeros(3), goals)
    assert (shorter >= -1e-9).all()
