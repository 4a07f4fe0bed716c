"""The grid on which all values of a criterion lie, such as 0.1 m where a simulator writes one decimal.

Between two of its values nothing is known: a rounded value above the threshold may stand for one below.
"""

from __future__ import annotations

import numpy as np

from worker.engine.systems.base import Floats

DISTINCT = 5
"""Different values below which none is stated: a verdict of yes or no has two."""
GRIDS = sorted({*(float(f"{m}e{k}") for k in range(-9, 4) for m in (1, 2, 2.5, 5)), *(2.0**-k for k in range(31))})
"""Decimal ones, and binary ones as of numbers in single precision."""
PRECISION = 64 * float(np.finfo(float).eps)
"""Relative size of what is rounding of the values themselves."""


def grid(costs: Floats) -> float:
    """The coarsest of `GRIDS` of which all differences of these values are multiples [criterion's unit]; 0 if there is
    none, and of fewer than `DISTINCT` different values."""
    known = np.unique(costs)
    if len(known) < DISTINCT:
        return 0.0
    size = float(np.abs(known).max())
    fine = [g for g in GRIDS if g > PRECISION * size]
    for some in (known[:: -(-len(known) // 100)], known):  # a few first: values that are not rounded fit none
        fine = [g for g in fine if _on(some, g, size)]
    return max(fine, default=0.0)


def _on(known: Floats, step: float, size: float) -> bool:
    steps = (known - known[0]) / step
    return bool((np.abs(steps - np.rint(steps)) <= PRECISION / 16 * size / step).all())
