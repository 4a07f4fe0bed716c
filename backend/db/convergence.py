"""Convergence history of the searches of a run: their best cost over its evaluations, thinned for the run list."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MOST = 32
"""Maximum number of points."""
DIGITS = 6
"""Significant digits of a stored cost: far finer than the sparkline resolves."""

History = list[list[float]]
"""[[evaluations, best cost within them]]: increasing counts, decreasing costs."""


def extended(history: Sequence[Sequence[float]], done: int, costs: NDArray[np.float64]) -> History | None:
    """The history extended by the costs (m,) of evaluations after the first `done`; None without an improvement."""
    longer = [list(step) for step in history]
    lowest = longer[-1][1] if longer else math.inf
    falling = np.fmin.accumulate(np.concatenate([[lowest], costs]))
    for i in np.flatnonzero(falling[1:] < falling[:-1]).tolist():
        cost = float(f"{costs[i]:.{DIGITS}g}")
        if not longer or cost < longer[-1][1]:
            longer.append([done + i + 1, cost])
    return thinned(longer) if len(longer) > len(history) else None


def thinned(history: History) -> History:
    """Choose at most `MOST` points: the first, the last, and the last point in each of equal intervals of a log
    axis."""
    if len(history) <= MOST:
        return history
    first, last = math.log(history[0][0]), math.log(history[-1][0])
    parts = MOST - 2
    kept = {min(parts - 1, int(parts * (math.log(step[0]) - first) / (last - first))): step for step in history[1:-1]}
    return [history[0], *kept.values(), history[-1]]
