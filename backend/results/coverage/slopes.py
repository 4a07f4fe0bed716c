"""The volume in which the slopes seen leave a violation possible.

Shubert's bound (SIAM J. Numer. Anal. 9, 1972) in several dimensions: a cost that changes nowhere faster than L is at
least cost_i - L distance_i everywhere. The true L is unknown; the steepest slope between near evaluations is used.
"""

from __future__ import annotations

import math

import numpy as np

from backend.results.coverage.schemas import PossibleVolume
from backend.results.coverage.tree import Floats, affordable, near, nearest, tree_of
from campaigns import thin

APART = 0.01
"""Evaluations nearer than this fraction of the ranges have no slope: there it measures jumps and rounding."""
NEIGHBOURS = 8
"""Number of near evaluations with which each is compared."""


def possible(points: Floats, costs: Floats, threshold: float) -> PossibleVolume | None:
    """The volume in which a violation is possible, or None if no two evaluations are far enough apart for a slope;
    points: (m, n), all with a cost."""
    slope = steepest(points, costs) if len(points) else None
    if slope is None:
        return None
    drawn = np.random.default_rng(1).random((affordable(points.shape[1]), points.shape[1]))
    share = _left(points, costs - threshold, slope, drawn) / len(drawn)
    error = math.sqrt(share * (1.0 - share) / len(drawn))
    return PossibleVolume(slope=slope, fraction=share, standard_error=error, points=len(drawn))


def steepest(points: Floats, costs: Floats) -> float | None:
    """The steepest slope between near evaluations, one of each cell whose sides are `APART`.

    With more parameters an even choice of them is compared with its neighbours among all.
    """
    cells = np.unique((points / APART).astype(np.int64), axis=0, return_index=True)[1]
    rows = np.sort(cells)
    chosen = rows[thin.even(len(rows), affordable(points.shape[1]))]
    distance, row = near(tree_of(points[rows]), points[chosen], 1 + NEIGHBOURS)
    apart = distance >= APART
    if not apart.any():
        return None
    rise = np.abs(costs[rows][row] - costs[chosen, None])
    return float((rise[apart] / distance[apart]).max())


def _left(points: Floats, margins: Floats, slope: float, drawn: Floats) -> int:
    """How many points are outside every ball around an evaluation with the radius margin / slope.

    Radii become distances in one more dimension (a power diagram; Aurenhammer, SIAM J. Comput. 16, 1987), so that the
    nearest evaluation decides.
    """
    above = margins > 0.0
    if slope == 0.0 or not above.any():
        return 0 if above.any() else len(drawn)
    squares = (margins[above] / slope) ** 2
    lifted = np.column_stack([points[above], np.sqrt(squares.max() - squares)])
    distance = nearest(tree_of(lifted), np.column_stack([drawn, np.zeros(len(drawn))]))
    return int((distance**2 >= squares.max()).sum())
