"""Steering for planners: the geodesic between two configurations as a distance and a path."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Union

import numpy as np
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
    answer is known: ask for many rows at once. Calls may come from many threads at once. Made by `Scene.steering`.
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
        ways = self._core.ways(numbers("start", start), numbers("goal", goal), count, samples)
        return [Way(**way) for way in ways]

    def distance(
        self, start: npt.ArrayLike, goal: npt.ArrayLike, threads: int = 0
    ) -> Union[float, Array]:
        """The length, or the action where the scene has none; infinite where nothing was found.

        (n,) and (n,) give a number; (N, n) and (N, n) give N numbers, on all cores or on `threads`.
        One of the two may be (n,) while the other is (N, n).
        """
        rows = row_pairs(start, goal)
        found = self._core.distances(rows[0], rows[1], threads)
        return float(found[0]) if np.ndim(start) == np.ndim(goal) == 1 else found

    def __reduce__(self) -> Any:
        return Steering, (self._scene, *self._made_with)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Steering):
            return NotImplemented
        return self._scene == other._scene and self._made_with == other._made_with

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Steering of {self._scene.name}>"

