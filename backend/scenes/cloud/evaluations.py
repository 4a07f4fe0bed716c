"""A run's stored evaluations as points of its parameter space: their positions, and picking by a ray.

`drawn` draws the points, `tab` is the part of the panel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db.tables import Finding, Stage
from backend.results import evaluations
from backend.results.schemas import Evaluations
from backend.scenes.base.noise import STATED, Noise, draws
from backend.scenes.base.setting import NOMINAL, Setting

Floats = NDArray[np.float64]

MOST = 6000
"""Approximate number of drawn evaluations, including the lowest of every search."""
LEAST = 400
"""Minimum number of each stage."""
REACH = 0.02
"""Maximum angle between a click and its point [rad]."""
SAME = 0.004
"""Points within this angle of each other are considered aligned: the nearest is picked [rad]."""


@dataclass(frozen=True)
class Evaluation:
    """One stored evaluation."""

    stage: str
    """Position, kind and method."""
    index: int
    """From 0 within the stage."""
    status: str
    cost: float | None
    parameters: dict[str, float]
    noise: Noise = STATED
    """The noise realisation that it used."""
    reason: str = ""
    """Why it has no value, if that is stored."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """The drawn evaluations, and the total number."""

    drawn: list[Evaluation]
    marks: dict[str, tuple[dict[str, float], float | None]]
    """The nominal case and the findings: parameters and cost by label."""
    total: int
    failed: int
    """Includes timeouts."""
    excluded: int

    @property
    def costs(self) -> Floats:
        """(n,); NaN without a cost."""
        return np.array([np.nan if one.cost is None else one.cost for one in self.drawn])

    @property
    def range(self) -> tuple[float, float] | None:
        """Lowest and highest drawn value, including those of the marks."""
        marked = [cost for _, cost in self.marks.values() if cost is not None]
        known = np.concatenate([self.costs, marked])
        known = known[np.isfinite(known)]
        return (float(known.min()), float(known.max())) if known.size else None

    def count(self, *statuses: str) -> int:
        """The number of drawn evaluations with one of these statuses."""
        return sum(one.status in statuses for one in self.drawn)


def load(reader: sa.Connection, run_id: int, setting: Setting, nominal: float | None) -> Cloud:
    """The stored evaluations; `nominal` is the cost of the nominal case, if known."""
    stages = reader.scalar(
        sa.select(sa.func.count()).select_from(Stage).where(Stage.run_id == run_id, Stage.evaluations > 0)
    )
    found = evaluations.read(reader, run_id, max(LEAST, MOST // max(1, stages or 0)), None)
    rows = reader.execute(
        sa.select(Finding.label, Finding.parameters, Finding.cost).where(Finding.run_id == run_id)
    ).all()
    marks = {NOMINAL: ({one.path: one.nominal for one in setting.uncertain}, nominal)}
    marks |= {row.label: (row.parameters, row.cost) for row in sorted(rows, key=lambda r: (len(r.label), r.label))}
    return Cloud(
        drawn=_drawn(found, draws(reader, run_id, setting.document)),
        marks=marks,
        total=sum(stage.total for stage in found.stages),
        failed=sum(stage.failed for stage in found.stages),
        excluded=sum(stage.excluded for stage in found.stages),
    )


def _drawn(found: Evaluations, own: Mapping[int, int]) -> list[Evaluation]:
    """The evaluations that remain after thinning, and every failure with a stored reason."""
    called = {s.position: f"{s.position} · {s.kind}{f' · {s.method}' if s.method else ''}" for s in found.stages}
    reasons = {(lost.position, lost.index): lost.reason for lost in found.failures}
    drawn: dict[tuple[int, int], Evaluation] = {}

    def noise(position: int, index: int) -> Noise:
        return Noise(draw=index) if index < own.get(position, 0) else STATED

    for stage in found.stages:
        for row, index in enumerate(stage.index):
            values = {path: column[row] for path, column in stage.parameters.items()}
            one = Evaluation(
                called[stage.position],
                index,
                stage.status[row],
                stage.cost[row],
                values,
                noise(stage.position, index),
                reasons.get((stage.position, index), ""),
            )
            drawn[stage.position, index] = one
    for lost in found.failures:
        one = Evaluation(
            called[lost.position],
            lost.index,
            lost.status,
            None,
            lost.parameters,
            noise(lost.position, lost.index),
            lost.reason,
        )
        drawn.setdefault((lost.position, lost.index), one)
    return list(drawn.values())


@dataclass(frozen=True)
class Axis:
    """One axis of the cloud: an uncertain parameter, or the criterion's value where `path` is empty."""

    name: str
    unit: str
    low: float
    high: float
    path: str = ""

    @property
    def title(self) -> str:
        """The name of the axis with its unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def fraction(self, parameters: Mapping[str, float], cost: float | None) -> float:
        """The position on the axis, 0 at its low end; NaN without a value."""
        value = parameters.get(self.path, np.nan) if self.path else (np.nan if cost is None else cost)
        return (value - self.low) / (self.high - self.low) if self.high > self.low else 0.5 + 0.0 * value


def axes(setting: Setting, cloud: Cloud) -> dict[str, Axis]:
    """All axes by title: the uncertain parameters, then the criterion's value."""
    low, high = cloud.range or (0.0, 0.0)
    value = Axis(setting.quantity or "value", setting.unit, low, high)
    found = [Axis(one.path, one.unit, one.low, one.high, one.path) for one in setting.uncertain]
    return {axis.title: axis for axis in (*found, value)}


Axes = Sequence[Axis | None]
"""The axes along x, y and z; None if not used."""


NO_VALUE = -0.08
"""Position of evaluations without a value on the criterion's axis."""


def places(cloud: Cloud, picked: Axes) -> Floats:
    """The positions of all drawn evaluations in the unit cube (n, 3); the centre for an unused axis."""
    return np.array([place(picked, one.parameters, one.cost) for one in cloud.drawn]).reshape(-1, 3)


def place(picked: Axes, parameters: Mapping[str, float], cost: float | None) -> list[float]:
    """The position of one case in the unit cube."""
    shares = [0.5 if axis is None else axis.fraction(parameters, cost) for axis in picked]
    return [NO_VALUE if np.isnan(share) else share for share in shares]


def met(points: Floats, origin: Any, direction: Any) -> int | None:
    """The point (n, 3) that a camera ray picks: the nearest on the screen, the front one if aligned."""
    if len(points) == 0:
        return None
    ray = np.asarray(direction, dtype=np.float64)
    ray = ray / np.linalg.norm(ray)
    to = points - np.asarray(origin, dtype=np.float64)
    ahead = to @ ray
    angle = np.arctan2(np.linalg.norm(to - ahead[:, None] * ray, axis=1), ahead)
    best = float(angle.min())
    if best > REACH:
        return None
    near = np.flatnonzero(angle <= min(REACH, best + SAME))
    return int(near[np.argmin(np.linalg.norm(to[near], axis=1))])
