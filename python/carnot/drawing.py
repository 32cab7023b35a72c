"""Pictures by matplotlib: paths with the body along them, fields, continuations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Union

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation

from carnot.values import Array

if TYPE_CHECKING:
    from carnot.continuation import Continuation
    from carnot.field import Field
    from carnot.flow import Flow
    from carnot.geodesic import Geodesic
    from carnot.scene import Scene

    Run = Union[Flow, Geodesic]

BODY = {"color": "0.35", "linewidth": 0.8}
WHEEL = {"color": "black", "linewidth": 2.0}
FORBIDDEN = {"facecolor": "0.8", "edgecolor": "0.5", "linewidth": 0.8, "zorder": 0}


def with_unit(name: str, unit: str) -> str:
    """An axis label."""
    return f"{name} [{unit.replace('^2', '²').replace('^3', '³')}]" if unit else name


def plot_path(run: Run, ax: Any, bodies: int, style: dict[str, Any]) -> Any:
    """The path in the plane or in space, or coordinates over time where a scene has no drawing."""
    scene = run.scene
    view = scene._about["drawing"]["view"]
    if len(run.q) == 0:
        raise ValueError("samples: there are none to draw; accepted: a search with samples")
    if view == "time":
        return _plot_over_time(run, ax, style)
    ax = _axes(scene, ax)
    points = scene._model.path(run.q)
    _draw_forbidden(scene, ax)
    for row in scene._model.instants(run.q, bodies) if bodies > 0 else ():
        for role, line in scene._model.body(run.q[row]):
            ax.plot(*line.T, **(WHEEL if role == "wheel" else BODY))
    path = scene._about["drawing"]["path"] or "path"
    ax.plot(*points.T, **{"label": path, "color": "C0", "zorder": 3, **style})
    for row, mark, name in ((0, "o", "start"), (-1, "s", "end")):
        ax.plot(*points[row, :, None], mark, color="C3", markersize=4, zorder=4, label=name)
    _frame(scene, ax, points)
    ax.set_title(_title(run))
    ax.legend(loc="best", fontsize="small", framealpha=0.6)
    return ax


def animate_path(run: Run, frames: int, seconds: float) -> FuncAnimation:
    """The body moves along the path."""
    scene = run.scene
    if scene._about["drawing"]["view"] == "time":
        raise ValueError("animate: this scene has no drawing; accepted: plot()")
    ax = plot_path(run, None, 0, {"alpha": 0.4})
    rows = np.linspace(0, len(run.q) - 1, frames).round().astype(int)
    drawn: list[Any] = []

    def draw(frame: int) -> list[Any]:
        while drawn:
            drawn.pop().remove()
        q = run.q[rows[frame]]
        for role, line in scene._model.body(q):
            drawn.extend(ax.plot(*line.T, **(WHEEL if role == "wheel" else BODY)))
        drawn.extend(ax.plot(*scene._model.path(q[None]).T, "o", color="C0", markersize=5))
        return drawn

    return FuncAnimation(ax.figure, draw, frames=frames, interval=1000 * seconds / frames)


def plot_continuation(curve: Continuation, ax: Any) -> Any:
    """The action against what changes, or against s where that is a configuration."""
    if ax is None:
        ax = plt.figure().add_subplot()
    x = curve.value if curve.value.ndim == 1 else curve.s
    for branch in np.unique(curve.branch):
        chosen = curve.branch == branch
        ax.plot(x[chosen], curve.action[chosen], ".-", label=f"branch {branch}")
    units = {one["name"]: one["unit"] for one in curve.scene._about["parameters"]}
    name = with_unit(curve.name, "time" if curve.name == "time" else units.get(curve.name, ""))
    ax.set_xlabel(name if curve.value.ndim == 1 else f"s, the way of {curve.name!r}")
    ax.set_ylabel("action")
    ax.set_title(f"{curve.scene.name}: {curve.status}")
    ax.legend(loc="best", fontsize="small")
    return ax


def plot_field(field: Field, at: dict[str, float], ax: Any, levels: Any) -> Any:
    """Isolines of the distance over the first two axes that are not cut."""
    unknown = [name for name in at if name not in field.axes]
    free = [name for name in field.axes if name not in at][:2]
    if unknown or len(free) < 2:
        raise ValueError(
            f"at {sorted(at)}: accepted: values of axes, two of {list(field.axes)} left over"
        )
    index: list[Any] = []
    cuts = []
    for name, values in field.axes.items():
        if name in free:
            index.append(slice(None))
            continue
        nearest = int(np.abs(values - at.get(name, float(values[0]))).argmin())
        index.append(nearest)
        cuts.append(f"{name} = {values[nearest]:.3g}")
    if ax is None:
        ax = plt.figure().add_subplot()
    x, y = (field.axes[name] for name in free)
    drawn = ax.contour(x, y, field.distance[tuple(index)].T, levels)
    ax.clabel(drawn, fontsize="x-small")
    units = dict(zip(field.scene.coordinates, field.scene.units))
    ax.set_xlabel(with_unit(free[0], units[free[0]]))
    ax.set_ylabel(with_unit(free[1], units[free[1]]))
    if units[free[0]] == units[free[1]]:
        ax.set_aspect("equal")
    ax.set_title(f"{field.scene.name}: distance" + "".join(f", {cut}" for cut in cuts))
    return ax


def _title(run: Run) -> str:
    label = getattr(run, "label", None)
    return f"{run.scene.name}: action {run.action:.6g}" + (f", {label}" if label else "")


def _axes(scene: Scene, ax: Any) -> Any:
    if ax is not None:
        return ax
    space = scene._about["drawing"]["view"] == "space"
    return plt.figure().add_subplot(projection="3d" if space else None)


def _draw_forbidden(scene: Scene, ax: Any) -> None:
    for name, corners in scene._model.outlines():
        ax.fill(*corners.T, label=name, **FORBIDDEN)


def _frame(scene: Scene, ax: Any, points: Array) -> None:
    drawing = scene._about["drawing"]
    coordinates = drawing["place"] or [scene._about["coordinates"][i] for i in drawing["axes"]]
    labels = [with_unit(one["name"], one["unit"]) for one in coordinates]
    ax.set_xlabel(labels[0])
    ax.set_ylabel(labels[1])
    units = {one["unit"] for one in coordinates[: points.shape[1]]}
    if points.shape[1] == 3:
        ax.set_zlabel(labels[2])
    if len(units) == 1:
        ax.set_aspect("equal", adjustable="datalim" if points.shape[1] == 2 else None)


def _plot_over_time(run: Run, ax: Any, style: dict[str, Any]) -> Any:
    if ax is None:
        ax = plt.figure().add_subplot()
    for name, unit, values in zip(run.scene.coordinates, run.scene.units, run.q.T):
        ax.plot(run.t, values, **{"label": with_unit(name, unit), **style})
    ax.set_xlabel("t [time]")
    ax.set_title(_title(run))
    ax.legend(loc="best", fontsize="small")
    return ax
