"""Initial value problems."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any, Optional

from carnot.values import Array, Value, array, number

if TYPE_CHECKING:
    from carnot.scene import Scene


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Flow(Value):
    """A run of a method from given initial data, measured. It is false where a step failed.

    `q`, `p`, `multipliers`, `t` and `hamiltonian` are samples, as in Geodesic; the last row is the
    end of the run.
    """

    scene: Scene
    method: str
    completed: bool
    message: str  #: why not
    time: float
    step: Optional[float]
    steps: int
    time_reached: float
    action: float
    length: Optional[float]
    energy_drift: float  #: max |H - H(0)|
    constraint_error: float
    evaluations: int
    elapsed_seconds: float
    t: Array
    q: Array
    p: Array
    multipliers: Array
    hamiltonian: Array
    tangent: Optional[Array]  #: d(q, p)(T) / d(q, p)(0), where it was asked for
    symplecticity_defect: Optional[float]  #: max-norm of M'JM - J

    def __bool__(self) -> bool:
        return self.completed

    def __repr__(self) -> str:
        how = "completed" if self.completed else f"failed: {self.message}"
        return (
            f"<Flow of {self.scene.name}: {self.steps} steps of {self.method} to "
            f"t = {self.time_reached:g}, {how}>"
        )

    def plot(self, ax: Any = None, bodies: int = 12, **style: Any) -> Any:
        """As Geodesic.plot."""
        from carnot import drawing

        return drawing.plot_path(self, ax, bodies, style)

    def animate(self, frames: int = 100, seconds: float = 4.0) -> Any:
        """As Geodesic.animate."""
        from carnot import drawing

        return drawing.animate_path(self, frames, seconds)


def flow_of(
    scene: Scene, json: dict[str, Any], action: float, length: float, trajectory: dict[str, Array]
) -> Flow:
    """Of the program's JSON and what it leaves out."""
    tangent = json.get("tangent")
    step = json["step"]
    defect = json.get("symplecticity_defect")
    return Flow(
        scene=scene,
        method=json["method"],
        completed=json["status"] == "completed",
        message=json["message"],
        time=float(json["time"]),
        step=None if step is None else float(step),
        steps=json["steps"],
        time_reached=number(json["time_reached"]),
        action=action,
        length=None if math.isnan(length) else length,
        energy_drift=number(json["energy_drift"]),
        constraint_error=number(json["constraint_error"]),
        evaluations=json["evaluations"],
        elapsed_seconds=float(json["elapsed_seconds"]),
        **trajectory,
        tangent=None if tangent is None else array(sum(tangent, [])).reshape(len(tangent), -1),
        symplecticity_defect=None if defect is None else float(defect),
    )
