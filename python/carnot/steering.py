"""Steering for planners: the geodesic between two configurations as a distance and a path."""

from __future__ import annotations

import dataclasses
import numbers as numbers_abc
from typing import TYPE_CHECKING, Any, Optional

import numpy.typing as npt

from carnot import _carnot
from carnot.values import Array, Value, numbers, row_pairs

if TYPE_CHECKING:
    from carnot.scene import Scene


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Way(Value):
    """One way between two configurations. It is false where none was found."""

    found: bool
    reason: str
    message: str
    distance: float  #: infinite where none was found
    q: Array  #: (samples, n), at equal times

    def __bool__(self) -> bool:
        return self.found

    def __repr__(self) -> str:
        return f"<Way: distance {self.distance:g}>" if self.found else f"<Way: {self.message}>"


class Steering:
    """Distances and paths, with answers kept.

    A call takes a tenth of a millisecond besides its searches, and a microsecond for each row whose
    answer is known: ask for many rows at once. Calls may come from many threads at once. Made by
    `Scene.steering`.
    """

    def __init__(
        self, scene: Scene, options: dict[str, str], mod_angles: bool, free_goal: list[bool]
    ) -> None:
        self._scene = scene
        self._made_with = (options, mod_angles, free_goal)
        self._core = _carnot.Steering(scene._model, options, mod_angles, free_goal)

    @property
    def scene(self) -> Scene:
        """Whose paths they are."""
        return self._scene

    @property
    def symmetric(self) -> bool:
        """Whether distance(a, b) == distance(b, a)."""
        return self._core.symmetric

    def steer(self, start: npt.ArrayLike, goal: npt.ArrayLike, samples: int = 101) -> Way:
        """The way of least action."""
        return self.alternatives(start, goal, 1, samples)[0]

    def alternatives(
        self, start: npt.ArrayLike, goal: npt.ArrayLike, count: int = 8, samples: int = 101
    ) -> list[Way]:
        """Up to `count` ways, least action first; one that is false where there is none.

        >>> import carnot
        >>> [bool(way) for way in carnot.scene("unicycle").steering().alternatives(
        ...     [0, 0, 0], [0, 1, 0], count=2)]
        [True, True]
        """
        ways = self._core.ways(
            numbers("start", start),
            numbers("goal", goal),
            _whole("count", count),
            _whole("samples", samples),
        )
        return [Way(**way) for way in ways]

    def distance(self, start: npt.ArrayLike, goal: npt.ArrayLike) -> float:
        """The length, or the action where the scene has none; infinite where nothing was found."""
        a, b = numbers("start", start), numbers("goal", goal)
        if a.ndim != 1 or b.ndim != 1:
            raise ValueError(
                f"goal: shape {b.shape}, start {a.shape}; accepted: one configuration each, "
                "distances() takes rows"
            )
        return float(self.distances(a, b, threads=1)[0])

    def distances(
        self, starts: npt.ArrayLike, goals: npt.ArrayLike, threads: Optional[int] = None
    ) -> Array:
        """The same of rows: N numbers of (N, n) and (N, n), on all cores or on `threads`.

        One of the two may be a single configuration.

        >>> import carnot, numpy
        >>> steer = carnot.scene("unicycle").steering()
        >>> steer.distances([0, 0, 0], numpy.eye(3)).round(6).tolist()
        [1.0, 3.340383, 1.0]
        """
        if threads is not None and not 1 <= threads <= 1024:
            raise ValueError(f"--threads {threads!r}: accepted: an integer from 1 to 1024")
        rows = row_pairs(starts, goals)
        return self._core.distances(rows[0], rows[1], threads or 0)

    def __reduce__(self) -> Any:
        return Steering, (self._scene, *self._made_with)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Steering):
            return NotImplemented
        return self._scene == other._scene and self._made_with == other._made_with

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Steering of {self._scene.name}>"


def _whole(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, numbers_abc.Integral):
        raise ValueError(f"{name} {value!r}: accepted: an integer")
    return int(value)
