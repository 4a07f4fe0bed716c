"""Whether a stored violation is in the basin of a case of the baseline: the line to it has no barrier.

A descent ends in one minimum, but another violation may lie downhill, too, so that a case that violates no more is
compared with all stored violations; those in one cell of the size at which two minima are one are compared once. What
the allowance does not suffice for is counted.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field

import numpy as np

from campaigns.results.base import OK
from worker.engine.search.base import Batch
from worker.engine.stages.parts import between, seeds
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Floats

STRIDES = (16, 4, 1)
"""A line is evaluated at every 16th of its points, then, if there is no barrier between these, more densely."""
POINTS = 64
"""Points of a line beyond the case."""
AT_ONCE = 32
"""Lines that are evaluated together."""


@dataclass
class Fall:
    """A case of the baseline, and the stored violation that has no barrier before it."""

    point: Floats
    cost: float | None
    """Under the realisations of the campaign; None until it is evaluated."""
    violation: Floats | None = None
    compared: set[tuple[int, ...]] = field(default_factory=set)
    """Cells whose nearest violation has a barrier before it."""


@dataclass
class Falls:
    """The cases that violate no more, by their index among all of the baseline, and the violations that validation
    itself evaluates."""

    cases: dict[int, Fall] = field(default_factory=dict)
    points: list[Floats] = field(default_factory=list)
    costs: list[Floats] = field(default_factory=list)

    def see(self, points: Floats, ranked: Floats, threshold: float) -> None:
        """Remember the violations of a batch."""
        violates = ranked <= threshold
        self.points.append(points[violates])
        self.costs.append(ranked[violates])


def begun(context: Context) -> dict[int, Fall]:
    """The cases that violated in the baseline and do not on this model."""
    baseline, threshold = context.campaign.baseline, context.problem.threshold
    again = [case for result in context.results.values() for case in result.reevaluated]
    rows = enumerate(zip(again, baseline.cases if baseline else [], strict=True))
    return {
        k: Fall(np.array(case.point), case.cost if case.realisation is None else None)
        for k, (case, before) in rows
        if case.cost is not None and before.stated <= threshold < case.cost
    }


def fall(context: Context, position: int, falls: Falls, room: int, barrier: float) -> Generator[Floats, Batch, bool]:
    """Compare every case with the violations that it was not compared with; returns whether there were any.

    room: evaluations that this may take; barrier: a rise by more than this is one.
    """
    points, costs = _violations(context, position, falls)
    distance, went_on = between.distance(context), False
    for case in falls.cases.values():
        if case.cost is None:
            (case.cost,) = (yield case.point[None, :]).ranked().tolist()
            room -= 1
        rows = _new(case, points, distance)
        while case.violation is None and len(rows) and room >= POINTS:
            some, rows = np.split(rows, [min(AT_ONCE, room // POINTS)])
            room -= yield from _compare(case, points[some], costs[some], barrier)
            case.compared.update(map(tuple, _cells(points[some], distance).tolist()))
            went_on = True
    return went_on


def not_compared(context: Context, position: int, falls: Falls, index: int) -> int:
    """How many violations a case was not compared with; those in one cell count once."""
    case = falls.cases.get(index)
    if case is None or case.violation is not None:
        return 0
    points, _ = _violations(context, position, falls)
    return len(_new(case, points, between.distance(context)))


def _violations(context: Context, position: int, falls: Falls) -> tuple[Floats, Floats]:
    """All that are stored, those with their own noise, too."""
    if not falls.cases:
        return np.empty((0, 0)), np.empty(0)
    before = range(position)
    stored = [columns for _, columns in seeds.stated(context, before)]
    stored += [columns for _, columns, _ in seeds.drawn(context, before)]
    violates = [(c.status == OK) & (c.costs[:, 0] <= context.problem.threshold) for c in stored]
    points = [c.points[rows] for c, rows in zip(stored, violates, strict=True)]
    costs = [c.costs[rows, 0] for c, rows in zip(stored, violates, strict=True)]
    return np.concatenate([*points, *falls.points]), np.concatenate([*costs, *falls.costs])


def _new(case: Fall, points: Floats, distance: float) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Rows of the violations to compare a case with, the nearest first: the nearest one in every other cell."""
    order = np.argsort(np.abs(points - case.point).max(axis=1, initial=0.0), kind="stable")
    cells, first = np.unique(_cells(points[order], distance), axis=0, return_index=True)
    new = [
        row for cell, row in zip(map(tuple, cells.tolist()), first.tolist(), strict=True) if cell not in case.compared
    ]
    return order[sorted(new)]


def _cells(points: Floats, distance: float) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    return np.floor(points / distance).astype(np.int64)


def _compare(case: Fall, ends: Floats, costs: Floats, barrier: float) -> Generator[Floats, Batch, int]:
    """Evaluate the lines to violations until each has a barrier; returns the number of evaluations."""
    values = np.full((len(ends), POINTS + 1), np.nan)
    values[:, 0], values[:, -1] = case.cost, costs
    rows, made = np.arange(len(ends)), 0
    for stride in STRIDES:
        at = np.array([k for k in range(stride, POINTS, stride) if np.isnan(values[rows[0], k])])
        lines = case.point + (at / POINTS)[None, :, None] * (ends[rows] - case.point)[:, None, :]
        batch = yield lines.reshape(-1, len(case.point))
        values[rows[:, None], at[None, :]] = batch.ranked().reshape(len(rows), len(at))
        made += len(rows) * len(at)
        rows = rows[_rises(values[rows][:, ::stride]) <= barrier]
        if not len(rows):
            return made
    case.violation = ends[rows[0]]
    return made


def _rises(values: Floats) -> Floats:
    """The largest rise along each line, above the lowest value before it."""
    with np.errstate(invalid="ignore"):  # infinite where there is no value
        return np.asarray((values - np.minimum.accumulate(values, axis=1)).max(axis=1))
