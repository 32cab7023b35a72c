import copy
import pickle

import numpy as np
import pytest

import carnot


def test_curve_is_that_of_the_program(car, answer):
    start = car.geodesics([0, 0, 0, 0], [2, 1, 0.5, 0.5]).best()
    curve = car.follow(start, alpha=0.5)
    arguments = "continue vehicle --from 0,0,0,0 --to 2,1,0.5,0.5 --along alpha=0.5 --guess".split()
    told = answer(*arguments, ",".join(map(repr, start.p0.tolist())))
    assert curve.status == told["status"] == "reached"
    assert curve
    assert curve.action.tolist() == [point["action"] for point in told["points"]]
    assert curve.value.tolist() == [point["value"] for point in told["points"]]
    assert curve.value[[0, -1]].tolist() == [1, 0.5]
    assert curve.p0.shape == (len(curve), 4)
    assert list(curve.label) == [point["label"] for point in told["points"]]


def test_target_start_and_time(car, parking):
    for changed in ({"to": [0, 0.9, 0, 0]}, {"start": [0, 0.1, 0, 0]}, {"time": 1.2}):
        curve = car.follow(parking.best(), **changed)
        assert curve.status == "reached"
        assert (curve.error < 1e-10).all()
    # The same problem, moved: the action is the same.
    there = car.follow(parking.best(), to=[0, 0.9, 0, 0]).action[-1]
    here = car.follow(parking.best(), start=[0, 0.1, 0, 0]).action[-1]
    assert there == pytest.approx(here, rel=1e-9)
    # T times the action stays as it is.
    assert curve.action[-1] * 1.2 == pytest.approx(parking.best().action, rel=1e-9)


def test_limits_move(car):
    limited = car.replace(limits={"phi - theta": (-0.5, 0.5)})
    start = limited.geodesics([0, 0, 0, 0], [0, 1, 0, 0], samples=257).best()
    curve = limited.follow(start, limits={"phi - theta": (-0.4, 0.4)})
    assert curve.status == "reached"
    assert curve.action[0] == pytest.approx(start.action, rel=1e-9)
    tight = car.replace(limits={"phi - theta": (-0.4, 0.4)})
    known = tight.geodesics([0, 0, 0, 0], [0, 1, 0, 0]).best().action
    assert curve.action[-1] == pytest.approx(known, rel=1e-9)
    assert curve.contact_changes[0]["after"] == ["phi - theta"]
    assert curve.value.shape == (len(curve), 2)


def test_refuses(car, parking):
    with pytest.raises(ValueError, match="geodesic"):
        car.follow(parking, alpha=2)
    with pytest.raises(ValueError, match="0 things change"):
        car.follow(parking.best())
    with pytest.raises(ValueError, match="2 things change"):
        car.follow(parking.best(), to=[0, 0, 0, 0], alpha=2)
    with pytest.raises(ValueError, match="alpah"):
        car.follow(parking.best(), alpah=2)
    with pytest.raises(ValueError, match="no such limit"):
        car.follow(parking.best(), limits={"phi - theta": (-0.3, 0.3)})
    with pytest.raises(ValueError, match="--max-points"):
        car.follow(parking.best(), alpha=2, max_points=0)


def test_curve_is_a_value(car, parking):
    curve = car.follow(parking.best(), to=[0, 0.98, 0, 0], labels=False)
    assert pickle.loads(pickle.dumps(curve)) == curve
    assert copy.deepcopy(curve) == curve
    assert len(curve) == len(curve.s) > 1


def test_method_keeps_what_it_declares():
    found = carnot.scene("heisenberg", method="gauss4").verify(steps=1000)
    assert found["as_declared"]
    assert found["measured_order"] == pytest.approx(4, abs=0.2)
    assert found["symplecticity_defect"] < 100 * np.finfo(float).eps
    radau = carnot.scene("heisenberg", method="radau5").verify(steps=1000)
    assert radau["symplecticity_verdict"] == "breaks"
    for name in ("heisenberg", "unicycle"):  # with a long run, and without
        with pytest.raises(ValueError, match="--steps"):
            carnot.scene(name).verify(steps=1)


def test_a_name_does_not_make_a_scene_one_of_the_program():
    text = "coordinates a, b, c\nkinetic = (a'^2 + b'^2 + c'^2) / 2\n"
    named = carnot.Scene(text, name="heisenberg").verify(steps=1000)
    other = carnot.Scene(text, name="other").verify(steps=1000)
    assert {**named, "scene": ""} == {**other, "scene": ""}
