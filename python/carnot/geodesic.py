"""Geodesics, and the report of a search."""

from __future__ import annotations

import dataclasses
import html
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union, overload

import numpy as np

from carnot.values import Array, Value, array, number

if TYPE_CHECKING:
    from carnot.scene import Scene


class NotConverged(RuntimeError):
    """There is no geodesic in the report: the message says why, and what to try."""


@dataclasses.dataclass(frozen=True, eq=False)
class LimitReport(Value):
    """How a path keeps to a limit."""

    name: str
    lowest_slack: float  #: the closest approach; negative beyond the limit
    active: tuple[tuple[float, float], ...]  #: when the path keeps to it
    largest_multiplier: float  #: action per time and unit of the limited value


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Geodesic(Value):
    """An extremal that joins two configurations, checked.

    With n coordinates, k multipliers and m samples `q` and `p` are (m, n), `multipliers` is (m, k),
    `t` and `hamiltonian` are (m,). Names and meanings are those of the program's JSON
    (docs/reports.md).
    """

    scene: Scene
    start: Array
    goal: Array
    time: float
    p0: Array  #: NaN where the label is "abnormal": no momentum leads along it
    lambda0: Array
    action: float
    length: Optional[float]  #: None where the scene has no mass matrix
    verification: str  #: "single", "knots" or "grid"
    error: float  #: endpoint error, defect at knots, or what the action may be wrong by
    transversality_error: float
    constraint_error: float
    energy_drift: float
    conjugate_times: Optional[Array]  #: in (0, T], by multiplicity; None if they are not known
    #: "locally-minimal", "conjugate-passed", "singular", "abnormal", "not-minimal" or "unknown"
    label: str
    abnormal: Optional[bool]
    morse_index: Optional[int]
    family_dimension: Optional[int]
    hits: int  #: starts that led here
    windings: tuple[int, ...]  #: whole periods added to the goal
    extremes: dict[str, float]  #: such as "largest_steering_angle"
    limits: tuple[LimitReport, ...]
    limit_violation: float
    t: Array
    q: Array
    p: Array
    multipliers: Array
    hamiltonian: Array

    def __repr__(self) -> str:
        return (
            f"<Geodesic of {self.scene.name}: action {self.action:.10g}, {self.label}, "
            f"error {self.error:.2g}>"
        )

    def plot(self, ax: Any = None, bodies: int = 12, **style: Any) -> Any:
        """Draws the path with the body along it, by matplotlib; returns the axes.

        `bodies` is the largest number of bodies, 0 for the path alone; `style` goes to the line of
        the path.
        """
        from carnot import drawing

        return drawing.plot_path(self, ax, bodies, style)

    def animate(self, frames: int = 100, seconds: float = 4.0) -> Any:
        """A matplotlib animation of the body along the path; save it, or show it in a notebook."""
        from carnot import drawing

        return drawing.animate_path(self, frames, seconds)


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Report(Value, Sequence[Geodesic]):
    """What a search gave: a sequence of geodesics, least action first.

    It is false where nothing was found; then `reason` is a code and `message` says what to try.
    """

    geodesics: tuple[Geodesic, ...]
    status: str  #: "converged", "not_converged" or "interrupted"
    reason: str  #: "none" where there is a geodesic
    message: str
    starts: int
    converged_starts: int
    missed_estimate: Optional[float]  #: Chao's estimate of how many were not found
    elapsed_seconds: float

    @overload
    def __getitem__(self, index: int) -> Geodesic: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Geodesic]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[Geodesic, Sequence[Geodesic]]:
        return self.geodesics[index]

    def __len__(self) -> int:
        return len(self.geodesics)

    def __iter__(self) -> Iterator[Geodesic]:
        return iter(self.geodesics)

    def best(self) -> Geodesic:
        """The geodesic of least action; raises NotConverged where there is none."""
        if not self.geodesics:
            raise NotConverged(self.message)
        return self.geodesics[0]

    def _table(self) -> list[list[str]]:
        names: list[str] = []
        for geodesic in self.geodesics:
            names += [name for name in geodesic.extremes if name not in names]
        limited = any(geodesic.limits for geodesic in self.geodesics)
        titles = [name.replace("_", " ") for name in names] + (["slack"] if limited else [])
        rows = [["#", "action", "length", "error", "label", *titles]]
        for rank, geodesic in enumerate(self.geodesics, 1):
            length = "-" if geodesic.length is None else f"{geodesic.length:.10g}"
            how = "" if geodesic.verification == "single" else f" ({geodesic.verification})"
            row = [str(rank), f"{geodesic.action:.10g}", length, f"{geodesic.error:.2g}{how}"]
            row += [geodesic.label]
            row += [f"{geodesic.extremes.get(name, np.nan):.6g}" for name in names]
            if limited:
                row.append(f"{min(limit.lowest_slack for limit in geodesic.limits):.2g}")
            rows.append(row)
        return rows

    def _summary(self) -> str:
        found = len(self.geodesics)
        text = f"{found} geodesic{'' if found == 1 else 's'}"
        text += f", {self.converged_starts} of {self.starts} starts converged"
        text += f", {self.elapsed_seconds:.3g} s"
        return text + (f"; {self.message}" if self.message else "")

    def __repr__(self) -> str:
        if not self.geodesics:
            return f"<Report: {self.status}, {self.reason}: {self.message}>"
        rows = self._table()
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() for row in rows]
        return "\n".join([*lines, self._summary()])

    def _repr_html_(self) -> str:
        head, *body = self._table()
        titles = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
        rows = "".join(
            "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
            for row in body
        )
        table = f"<table><thead><tr>{titles}</tr></thead><tbody>{rows}</tbody></table>"
        return (table if body else "") + f"<p>{html.escape(self._summary())}</p>"


def report_of(scene: Scene, json: dict[str, Any], trajectories: list[dict[str, Array]]) -> Report:
    """Of the program's JSON and the trajectories that belong to it."""
    geodesics = [
        _geodesic_of(scene, json, one, trajectory)
        for one, trajectory in zip(json["geodesics"], trajectories)
    ]
    missed = json["missed_estimate"]
    return Report(
        geodesics=tuple(geodesics),
        status="interrupted" if json["reason"] == "interrupted" else json["status"],
        reason=json["reason"],
        message=json["message"],
        starts=json["starts"],
        converged_starts=json["converged_starts"],
        missed_estimate=None if missed is None else float(missed),
        elapsed_seconds=float(json["elapsed_seconds"]),
    )


def error_of(one: dict[str, Any]) -> float:
    """By the way of verification."""
    kind = {"single": "endpoint_error", "knots": "knot_defect", "grid": "grid_error"}
    return number(one[kind[one["verification"]]])


def _numbers_or_nan(x: Any, n: int) -> Array:
    """The numbers of JSON, n; NaN where it has none."""
    return np.full(n, np.nan) if x is None else array(x)


def _geodesic_of(
    scene: Scene, json: dict[str, Any], one: dict[str, Any], trajectory: dict[str, Array]
) -> Geodesic:
    windings = tuple(one.get("windings", ()))
    goal = array(one.get("to_found", json["to"]))
    if windings:
        goal += np.array(windings) * scene.periods
    times = one["conjugate_times"]
    length = one["length"]
    return Geodesic(
        scene=scene,
        start=array(one.get("from_found", json["from"])),
        goal=goal,
        time=float(json["time"]),
        p0=_numbers_or_nan(one["p0"], trajectory["p"].shape[1]),
        lambda0=_numbers_or_nan(one["lambda0"], trajectory["multipliers"].shape[1]),
        action=float(one["action"]),
        length=None if length is None else float(length),
        verification=one["verification"],
        error=error_of(one),
        transversality_error=number(one.get("transversality_error", 0)),
        constraint_error=number(one["constraint_error"]),
        energy_drift=number(one["energy_drift"]),
        conjugate_times=None if times is None else array(times),
        label=one["label"],
        abnormal=one["abnormal"],
        morse_index=one["morse_index"],
        family_dimension=one["family_dimension"],
        hits=one["hits"],
        windings=windings,
        extremes={name: number(one[name]) for name in scene.extremes if name in one},
        limits=tuple(_limit_of(limit) for limit in one.get("limits", ())),
        limit_violation=number(one.get("limit_violation", 0)),
        **trajectory,
    )


def _limit_of(limit: dict[str, Any]) -> LimitReport:
    return LimitReport(
        name=limit["name"],
        lowest_slack=number(limit["lowest_slack"]),
        active=tuple((float(begin), float(end)) for begin, end in limit["active"]),
        largest_multiplier=number(limit["largest_multiplier"]),
    )
