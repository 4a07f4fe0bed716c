"""The lowest cost so far against evaluations, thinned for the small picture in the run list. Start at `extended`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MOST = 32
"""Points kept."""
DIGITS = 6
"""Significant digits kept of a cost: far finer than the picture."""

Course = list[list[float]]
"""[[evaluations, lowest cost within them]]: the one rises, the other falls."""


def extended(course: Sequence[Sequence[float]], flown: int, costs: NDArray[np.float64]) -> Course | None:
    """The course with further evaluations (m,), `flown` before them; None where none of them is lower."""
    longer = [list(step) for step in course]
    lowest = longer[-1][1] if longer else math.inf
    falling = np.fmin.accumulate(np.concatenate([[lowest], costs]))
    for i in np.flatnonzero(falling[1:] < falling[:-1]).tolist():
        cost = float(f"{costs[i]:.{DIGITS}g}")
        if not longer or cost < longer[-1][1]:
            longer.append([flown + i + 1, cost])
    return thinned(longer) if len(longer) > len(course) else None


def thinned(course: Course) -> Course:
    """At most `MOST` points: the first, the last, and the last in each of equal parts of a log axis between."""
    if len(course) <= MOST:
        return course
    first, last = math.log(course[0][0]), math.log(course[-1][0])
    parts = MOST - 2
    kept = {min(parts - 1, int(parts * (math.log(step[0]) - first) / (last - first))): step for step in course[1:-1]}
    return [course[0], *kept.values(), course[-1]]
