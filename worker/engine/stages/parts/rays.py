"""A ray from the nominal point: the nearest violation among its evaluations, or the nearest failure without one.

All evaluations on a ray count: its own steps, those of the bisection, and every stored one. Start reading at `Line`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.results.base import EXCLUDED, OK
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.stages.parts import seeds
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Floats

SAME = 1e-12
"""Fraction of a range by which a point may be off a ray by rounding."""


class Evaluated(NamedTuple):
    """Evaluations: points (m, n), costs (m,) of the deciding criterion, whether each failed (m,)."""

    points: Floats
    costs: Floats
    failed: NDArray[np.bool_]

    @classmethod
    def of(cls, points: Floats, batch: Batch | Columns) -> Evaluated:
        """Failed are those without a value that are not excluded."""
        failed = (batch.status != EXCLUDED) & (batch.status != OK)
        return cls(points, batch.costs[:, 0], np.asarray(failed))

    def some(self, rows: NDArray[np.intp] | slice) -> Evaluated:
        """These rows of it."""
        return Evaluated(self.points[rows], self.costs[rows], self.failed[rows])


@dataclass
class Line:
    """From the nominal point to `end`; the boundary is between the fractions `clear` and `beyond` of the ray.

    cost: at `beyond`; NaN if no evaluation violates and the boundary is that of a failure. failed: the first fraction
    at which an evaluation failed. point: the evaluation at `beyond`, broken: that at `failed`.
    """

    nominal: Floats
    end: Floats
    path: str
    towards: str
    clear: float = 0.0
    beyond: float = np.inf
    cost: float = np.nan
    failed: float = np.inf
    point: Floats | None = None
    broken: Floats | None = None
    _fractions: Floats = field(default_factory=lambda: np.empty(0))

    @property
    def violates(self) -> bool:
        """Whether an evaluation violates: then failures before it are no boundary."""
        return bool(np.isfinite(self.cost))

    @property
    def width(self) -> float:
        """The largest fraction of a range that is between `clear` and `beyond`; infinite without a boundary."""
        return float((self.beyond - self.clear) * np.abs(self.end - self.nominal).max())

    def at(self, fractions: Floats) -> Floats:
        """The points (m, n) at these fractions (m,)."""
        return np.asarray(self.nominal + fractions[:, None] * (self.end - self.nominal))

    def see(self, fractions: Floats, seen: Evaluated, threshold: float) -> None:
        """Narrow the interval by evaluations on the ray, at these fractions (m,)."""
        violating, failing = _first(fractions, seen.costs <= threshold), _first(fractions, seen.failed)
        if failing is not None and fractions[failing] < self.failed:
            self.failed, self.broken = float(fractions[failing]), seen.points[failing].copy()
        if violating is not None and (not self.violates or fractions[violating] < self.beyond):
            self.beyond, self.cost = float(fractions[violating]), float(seen.costs[violating])
            self.point = seen.points[violating].copy()
        elif not self.violates:
            self.beyond, self.point = self.failed, self.broken
        self._fractions = np.concatenate([self._fractions, fractions])
        self.clear = float(self._fractions[self._fractions < self.beyond].max(initial=0.0))

    def see_stored(self, problem: Problem, stored: Iterable[Evaluated]) -> None:
        """Narrow the interval by those of these evaluations that are on the ray."""
        for seen in stored:
            rows, fractions = self._on(problem, seen.points)
            if len(rows):
                self.see(fractions, seen.some(rows), problem.threshold)

    def _on(self, problem: Problem, points: Floats) -> tuple[NDArray[np.intp], Floats]:
        """The rows that are on the ray, and their fractions; a parameter that the ray does not vary has its value."""
        way = self.end - self.nominal
        longest = int(np.argmax(np.abs(way)))
        if way[longest] == 0.0 or not len(points):
            return np.empty(0, dtype=np.intp), np.empty(0)
        fractions = (points[:, longest] - self.nominal[longest]) / way[longest]
        rows = np.flatnonzero((fractions > 0.0) & (fractions <= 1.0))
        for k, (start, length) in enumerate(zip(self.nominal, way, strict=True)):
            rows = rows[np.abs(points[rows, k] - start - fractions[rows] * length) <= SAME]
        fixed = way == 0.0
        same = problem.values(points[rows])[:, fixed] == problem.values(self.nominal[None, :])[:, fixed]
        rows = rows[same.all(axis=1)]
        return rows, fractions[rows]


def stored(context: Context, positions: Iterable[int]) -> list[Evaluated]:
    """What these stages have evaluated under the realisations stated in the campaign."""
    return [Evaluated.of(columns.points, columns) for _, columns in seeds.stated(context, positions)]


def _first(fractions: Floats, those: NDArray[np.bool_]) -> int | None:
    """The row with the smallest of the fractions of those."""
    return int(np.argmin(np.where(those, fractions, np.inf))) if those.any() else None
