"""The volume in which the slopes seen leave a violation possible.

Shubert's bound (SIAM J. Numer. Anal. 9, 1972) in several dimensions: a cost that changes nowhere faster than L is at
least cost_i - L distance_i everywhere. The true L is unknown; the steepest slope between evaluations is used instead.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from backend.results.coverage.distances import Floats, blocks, nearest, squares
from campaigns import thin

APART = 0.01
"""Evaluations nearer than this fraction of the ranges have no slope: there it measures jumps and rounding."""
PAIRS = 20_000_000
"""Most pairs of evaluations that are compared."""
DRAWN = 4096
"""Random points at which the bound is computed."""


class Possible(NamedTuple):
    slope: float
    """The steepest one seen, in the criterion's unit per whole range of a parameter."""
    left: int
    """Of `DRAWN` random points, those at which this slope leaves a violation possible."""

    @property
    def fraction(self) -> float:
        return self.left / DRAWN

    @property
    def standard_error(self) -> float:
        return math.sqrt(self.fraction * (1.0 - self.fraction) / DRAWN)


def possible(points: Floats, costs: Floats, threshold: float) -> Possible | None:
    """None if no two evaluations are far enough apart for a slope; points: (m, n), all with a cost."""
    slope = steepest(points, costs)
    return None if slope is None else Possible(slope, _count(points, costs - threshold, slope))


def steepest(points: Floats, costs: Floats) -> float | None:
    """The steepest slope between an even choice of the evaluations and all of them, at most `PAIRS` pairs."""
    chosen = thin.even(len(points), max(1, PAIRS // len(points)))
    most = -1.0
    for part in blocks(len(chosen), len(points)):
        square = squares(points, points[chosen[part]])
        np.copyto(square, np.inf, where=square < APART**2)
        if square.min() < np.inf:
            rise = costs - costs[chosen[part], None]
            rise *= rise
            rise /= square
            most = max(most, float(rise.max()))
    return None if most < 0.0 else math.sqrt(most)


def _count(points: Floats, margins: Floats, slope: float) -> int:
    """How many drawn points are outside every ball around an evaluation with the radius margin / slope."""
    outside = margins > 0.0
    if slope == 0.0 or not outside.any():
        return 0 if outside.any() else DRAWN
    drawn = np.random.default_rng(1).random((DRAWN, points.shape[1]))
    return int((nearest(points[outside], drawn, (margins[outside] / slope) ** 2) >= 0.0).sum())
