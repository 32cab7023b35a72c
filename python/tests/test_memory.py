"""Calls leave nothing behind."""

import os
import resource

import numpy as np
import pytest

import carnot

KILOBYTES = 4000  # less than one trajectory a hundred calls


def growth(call, calls):
    """Of the largest memory, in kilobytes, after the first calls."""
    for _ in range(calls // 10):
        call()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(calls):
        call()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before


def refused(call):
    try:
        call()
    except ValueError:
        return
    raise AssertionError("not refused")


@pytest.mark.skipif("CARNOT_SANITIZED" in os.environ, reason="what is freed is kept for a while")
def test_calls_keep_no_memory(car, unicycle):
    q, p = np.zeros(4), np.array([1, 0, 0, 0.3])
    assert growth(lambda: car.evaluate(q, p), 100000) < KILOBYTES
    assert growth(lambda: car.flow(q, p, time=1, steps=2, samples=20), 5000) < KILOBYTES
    assert growth(lambda: unicycle.geodesics([0, 0, 0], [1, 0, 0]), 200) < KILOBYTES
    assert growth(lambda: unicycle.solve_many(np.zeros(3), [[1, 0, 0]]), 200) < KILOBYTES
    assert growth(lambda: carnot.scene("vehicle", length=2), 2000) < KILOBYTES
    assert growth(lambda: refused(lambda: car.evaluate(q, p * np.nan)), 20000) < KILOBYTES


def test_arrays_outlive_their_scene():
    report = carnot.scene("unicycle").geodesics([0, 0, 0], [0, 1, 0])
    q = report[0].q
    before = q.copy()
    del report
    for _ in range(20):
        carnot.scene("unicycle").geodesics([0, 0, 0], [1, 1, 0])
    assert (q == before).all()
