"""Values: what compares equal where all its numbers do, and prints and pickles like its parts."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal; NaN equals NaN, and arrays count as a whole."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        if not (isinstance(a, np.ndarray) and isinstance(b, np.ndarray)):
            return False
        if a.dtype != b.dtype or a.shape != b.shape:
            return False
        numbers = a.dtype.kind in "fc"
        return bool(np.array_equal(a, b, equal_nan=numbers))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    if isinstance(a, float) and isinstance(b, float) and a != a:
        return b != b
    return bool(a == b)


class Value:
    """A dataclass whose fields may be arrays.

    It equals another one where all its fields do, but for the seconds that it took.
    """

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        names = [field.name for field in dataclasses.fields(self)]
        return all(
            same(getattr(self, name), getattr(other, name))
            for name in names
            if name != "elapsed_seconds"
        )


def numbers(name: str, x: Any) -> Array:
    """An array of doubles, contiguous; ValueError for what are no numbers."""
    given = np.asarray(x)
    if given.dtype.kind not in "iuf":
        raise ValueError(f"{name}: dtype {given.dtype}; accepted: real numbers")
    return np.ascontiguousarray(given, dtype=np.float64)


def row_pairs(starts: Any, goals: Any) -> tuple[Array, Array]:
    """As many starts as goals, (N, n) each; one of them may be a single one, (n,)."""
    a = np.atleast_2d(numbers("starts", starts))
    b = np.atleast_2d(numbers("goals", goals))
    if a.shape[1:] != b.shape[1:] or (len(a) != len(b) and 1 not in (len(a), len(b))):
        raise ValueError(
            f"goals: shape {b.shape}, but starts have {a.shape}; accepted: as many, or one for all"
        )
    count = max(len(a), len(b)) if min(len(a), len(b)) > 0 else 0
    shape = (count, *a.shape[1:])
    return np.broadcast_to(a, shape), np.broadcast_to(b, shape)


def number(x: Any) -> float:
    """A number of JSON; NaN where it is null."""
    return float("nan") if x is None else float(x)


def array(x: Any) -> Array:
    """A list of numbers of JSON."""
    return np.array([number(item) for item in x], dtype=np.float64)
