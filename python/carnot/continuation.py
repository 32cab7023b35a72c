"""A geodesic followed while an end, the time or a parameter changes."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from carnot.geodesic import error_of
from carnot.values import Array, Value, array, number

if TYPE_CHECKING:
    from carnot.scene import Scene


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Continuation(Value):
    """Points of a curve of geodesics, in its order. Arrays have a row for each point.

    It is true where the curve was followed to an end of the line, or until it closed.
    """

    scene: Scene
    name: str  #: what changes: "to", "from", "time", "limit:NAME" or a parameter
    status: str  #: "reached", "returned", "closed", or how it stopped before
    message: str
    s: Array  #: from 0 to 1 along the line of problems
    branch: npt.NDArray[np.int64]
    value: Array  #: of what changes
    action: Array
    length: Array
    p0: Array
    error: Array
    morse_index: Array  #: NaN where it is not known
    label: tuple[str, ...]
    folds: tuple[dict[str, Any], ...]
    branch_points: tuple[dict[str, Any], ...]
    contact_changes: tuple[dict[str, Any], ...]  #: where arcs on limits come and go
    elapsed_seconds: float

    def __len__(self) -> int:
        return len(self.s)

    def __bool__(self) -> bool:
        return self.status in ("reached", "returned", "closed")

    def __repr__(self) -> str:
        return (
            f"<Continuation of {self.scene.name} along {self.name}: {self.status}, "
            f"{len(self)} points, {len(self.folds)} folds>"
        )

    def plot(self, ax: Any = None) -> Any:
        """Draws the action against what changes; returns the axes."""
        from carnot import drawing

        return drawing.plot_continuation(self, ax)


def continuation_of(scene: Scene, json: dict[str, Any]) -> Continuation:
    """Of the program's JSON."""
    points = json["points"]

    def column(name: str) -> Array:
        return array([point[name] for point in points])

    values = [np.atleast_1d(array(np.atleast_1d(point["value"]))) for point in points]
    wide = np.array(values).reshape(len(points), -1)
    return Continuation(
        scene=scene,
        name=json["along"]["name"],
        status=json["status"],
        message=json["message"],
        s=column("s"),
        branch=np.array([point["branch"] for point in points], dtype=np.int64),
        value=wide[:, 0] if wide.shape[1] == 1 else wide,
        action=column("action"),
        length=column("length"),
        p0=np.array([array(point["p0"]) for point in points]).reshape(len(points), -1),
        error=np.array([error_of(point) for point in points]),
        morse_index=array([number(point["morse_index"]) for point in points]),
        label=tuple(point["label"] for point in points),
        folds=tuple(json["folds"]),
        branch_points=tuple(json["branch_points"]),
        contact_changes=tuple(json.get("contact_changes", ())),
        elapsed_seconds=float(json["elapsed_seconds"]),
    )
