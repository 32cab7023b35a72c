"""The least action from one start to every point of a grid."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
import numpy.typing as npt

from carnot.values import Array, Value

if TYPE_CHECKING:
    from carnot.scene import Scene

LABELS = np.array(
    ["locally-minimal", "conjugate-passed", "singular", "unknown", "abnormal", "not-minimal", ""]
)


def labels_of(codes: Array) -> npt.NDArray[np.str_]:
    """Names of labels; empty for NaN."""
    known = np.where(np.isnan(codes), len(LABELS) - 1, codes).astype(int)
    return np.asarray(LABELS[known])


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Field(Value):
    """Arrays shaped like the grid, its first axis first; `p0` has n numbers for each point.

    What is not known of a point is NaN, and `reason` says why.
    """

    scene: Scene
    start: Array
    time: float
    axes: dict[str, Array]
    action: Array
    p0: Array
    error: Array  #: of an independent flow, or of knots
    label: npt.NDArray[np.str_]
    reason: npt.NDArray[np.str_]
    finished: bool
    searches: int
    flows: int
    settled: bool  #: whether the sweeps went on until nothing changed
    unkept: int  #: points that a neighbour promised less than is known of them
    triangles: int  #: triangles between neighbours that were looked at,
    violations: int  #: and those in which one path is longer than the other two
    checked: int  #: points that were searched again,
    lower: int  #: and where that found less
    bound: float  #: of the share of such points, with 95 per cent confidence
    elapsed_seconds: float

    @property
    def distance(self) -> Array:
        """The length of the geodesics: sqrt(2 T action)."""
        return np.asarray(np.sqrt(2 * self.time * self.action))

    def __repr__(self) -> str:
        shape = " x ".join(f"{name} {len(values)}" for name, values in self.axes.items())
        known = int(np.isfinite(self.action).sum())
        return (
            f"<Field of {self.scene.name}: {shape}, {known} of {self.action.size} points, "
            f"{self.lower} of {self.checked} checked lower>"
        )

    def plot(
        self, at: Optional[Mapping[str, float]] = None, ax: Any = None, levels: Any = 15
    ) -> Any:
        """Draws isolines of the distance over two axes; returns the axes of matplotlib.

        `at` says where the other axes are cut, at the grid's nearest value; it is their first value
        where nothing is said.
        """
        from carnot import drawing

        return drawing.plot_field(self, dict(at or {}), ax, levels)


def field_of(
    scene: Scene, start: Array, time: float, axes: dict[str, Array], found: dict[str, Any]
) -> Field:
    """Of what the library gives."""
    shape = tuple(len(values) for values in axes.values())
    if not found["finished"]:  # nothing is known of a field that was stopped
        points = int(np.prod(shape))
        for name in ("action", "error", "label"):
            found[name] = np.full(points, np.nan)
        found["p0"] = np.full((points, len(start)), np.nan)
        found["reason"] = ["interrupted"] * points
    return Field(
        scene=scene,
        start=start,
        time=time,
        axes=axes,
        action=found["action"].reshape(shape),
        p0=found["p0"].reshape(*shape, -1),
        error=found["error"].reshape(shape),
        label=labels_of(found["label"]).reshape(shape),
        reason=np.array(found["reason"], dtype="U21").reshape(shape),
        finished=found["finished"],
        searches=found["searches"],
        flows=found["flows"],
        settled=found["settled"],
        unkept=found["unkept"],
        triangles=found["triangles"],
        violations=found["violations"],
        checked=found["checked"],
        lower=found["lower"],
        bound=found["bound"],
        elapsed_seconds=found["elapsed_seconds"],
    )
