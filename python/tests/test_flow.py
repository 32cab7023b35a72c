import copy
import math
import pickle

import numpy as np
import pytest

import carnot

EPSILON = np.finfo(float).eps
Q0 = [1, 0.5, 0.3, 0.8]
P0 = [0.7, -0.2, 0.4, 0.2]


@pytest.mark.parametrize(
    "options, arguments",
    [
        ({"steps": 100}, ["--steps", "100"]),
        ({"step": 0.3}, ["--step", "0.3"]),
        ({"tolerance": 1e-10}, ["--tolerance", "1e-10"]),
        ({"steps": 50, "method": "radau5"}, ["--steps", "50", "--method", "radau5"]),
        ({"steps": 20, "tangent": True}, ["--steps", "20", "--tangent"]),
        ({"steps": 20, "samples": 7}, ["--steps", "20", "--samples", "7"]),
        ({"steps": 20, "start_time": 2}, ["--steps", "20", "--start-time", "2"]),
    ],
)
def test_is_that_of_the_program_to_the_last_bit(options, arguments, answer):
    run = carnot.scene("vehicle-cosine").flow(Q0, P0, time=10, **options)
    ends = ["--from", ",".join(map(str, Q0)), "--momentum", ",".join(map(str, P0))]
    told = answer("flow", "vehicle-cosine", *ends, "--time", "10", *arguments)
    assert run.completed
    assert run
    for key in ("method", "steps", "step", "energy_drift", "constraint_error", "evaluations"):
        assert getattr(run, key) == told[key], key
    for key in ("t", "q", "p", "hamiltonian"):
        assert getattr(run, key).tolist() == told["trajectory"][key], key
    assert run.multipliers.tolist() == told["trajectory"]["lambda"]
    if options.get("tangent"):
        assert run.tangent.tolist() == told["tangent"]
        assert run.symplecticity_defect == told["symplecticity_defect"]
    else:
        assert run.tangent is None


def test_without_samples(car):
    run = car.flow(Q0, P0, time=1, steps=10, samples=0)
    assert run.completed
    assert run.q.shape == (0, 4)
    assert run == car.flow(Q0, P0, time=1, steps=10, samples=0)


def test_velocity_gives_the_momentum(car, answer):
    velocity = [math.cos(0.8), math.sin(0.8), math.sin(0.5), 0.2]
    run = car.flow(Q0, velocity=velocity, multipliers=[0.1, 0.2], time=1, steps=10)
    assert run.p[0] == pytest.approx(car.momentum(Q0, velocity, [0.1, 0.2]), abs=8 * EPSILON)
    energy, v, multipliers = car.evaluate(run.q[0], run.p[0])
    assert energy == run.hamiltonian[0]
    assert v == pytest.approx(velocity, abs=8 * EPSILON)
    assert multipliers == pytest.approx([0.1, 0.2], abs=8 * EPSILON)


def test_length_of_a_straight_line(unicycle):
    run = unicycle.flow([0, 0, 0], [2, 0, 0], time=3, steps=10)
    assert run.length == pytest.approx(6, abs=16 * EPSILON * 6)
    assert run.action == pytest.approx(6, abs=16 * EPSILON * 6)
    assert carnot.scene("kapitza-pendulum").flow([1], [0], time=1, steps=9).length is None


def test_tangent_is_symplectic(car):
    m = car.flow(Q0, P0, time=5, steps=50, tangent=True).tangent
    j = np.block([[np.zeros((4, 4)), -np.eye(4)], [np.eye(4), np.zeros((4, 4))]])
    # The product of matrices rounds by the square of their size.
    assert np.abs(m.T @ j @ m - j).max() < 100 * EPSILON * np.abs(m).max() ** 2


def test_failure_is_false_and_says_where(unicycle):
    run = carnot.scene("plate-ball").flow(
        [0, 0, 0, math.pi / 2, 0], [1, 0, 0, 0, 1], time=1, steps=5
    )
    assert not run
    assert run.message
    assert run.time_reached == 0
    assert "failed" in repr(run)


@pytest.mark.parametrize(
    "options",
    [{}, {"steps": 0}, {"steps": 10, "step": 0.1}, {"tolerance": 0}, {"steps": 5, "time": 0}],
)
def test_refuses_in_the_words_of_the_program(options, car, refusal):
    arguments = ["--from", "0,0,0,0", "--momentum", "1,0,0,0"]
    for name, value in {"time": 1, **options}.items():
        arguments += [f"--{name}", str(value)]
    with pytest.raises(ValueError) as error:
        car.flow([0, 0, 0, 0], [1, 0, 0, 0], **{"time": 1, **options})
    assert str(error.value) == refusal("flow", "vehicle", *arguments)


def test_refuses_velocities_that_slip_and_singular_points(car):
    with pytest.raises(ValueError, match="violates the constraints"):
        car.flow([0, 0, 0, 0], velocity=[0, 1, 0, 0], time=1, steps=10)
    with pytest.raises(ValueError, match="4 numbers"):
        car.evaluate([0, 0, 0], [0, 0, 0, 0])
    with pytest.raises(ValueError, match="holds nan"):
        car.evaluate([0, 0, 0, math.nan], [0, 0, 0, 0])
    with pytest.raises(ValueError):
        carnot.scene("plate-ball").evaluate([0, 0, 0, math.pi / 2, 0], [1, 0, 0, 0, 1])


def test_is_a_value(car):
    run = car.flow(Q0, P0, time=1, steps=10, tangent=True)
    for twin in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert twin == run
    assert run != car.flow(Q0, P0, time=1, steps=11, tangent=True)
