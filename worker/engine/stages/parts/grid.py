"""The grid on which the values of a criterion lie, such as 0.1 m where a simulator writes one decimal.

Between two of its values nothing is known: a rounded value above the threshold may stand for one below. It is the grid
of the lowest values that matters: significant digits are coarse where values are large, and a constant may be no
multiple. Values that are rounded inside a formula, such as the depth of a whole number of pixels, are on no grid, but
few, and return often; then the lowest gap is the step.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from worker.engine.systems.base import Floats

LOWEST = 100, 30, 10
"""So many of the lowest different values have a grid of their own: a few where higher ones have other digits."""
DISTINCT, AGAIN, OFTEN = 5, 20, 5
"""Fewer different values lie on a grid by chance, unless each stands for so many values on average, and each of the two
lowest for so many; so many of the lowest are rounded, on a grid or not, if each returns so often."""
GRIDS = sorted({*(float(f"{m}e{k}") for k in range(-9, 4) for m in (1, 2, 2.5, 5)), *(2.0**-k for k in range(31))})
"""Decimal ones, and binary ones as of numbers in single precision."""
PRECISION = 64 * float(np.finfo(float).eps)
"""Relative size of what is rounding of the values themselves."""
GAP = 0.999
"""A step below this fraction of the smallest gap divides the lowest values, but is not their own."""
PARTS, SURE, DIGITS = 100, 1024, 12
"""Any other step is at least the smallest gap between two values divided by so many, and so many times what is rounding
where it is compared; digits of it."""


def grid(costs: Floats) -> float:
    """The coarsest step of which all differences of these values are multiples, or those of the lowest of them, such as
    a tenth of a foot [criterion's unit]; the gap between the two lowest if these return often and have no step of their
    own; 0 if there is none."""
    known, times = np.unique(costs, return_counts=True)
    if len(known) < DISTINCT and not _return(known, times):
        return 0.0
    step = max(_grid(some) for some in (known, *(known[:count] for count in LOWEST)))
    gaps = np.diff(known[:DISTINCT])
    rounded = _return(known[:DISTINCT], times[:DISTINCT]) and (len(known) < DISTINCT or times[:DISTINCT].min() >= OFTEN)
    return float(gaps[0]) if rounded and step < GAP * gaps.min() else step


def _return(known: Floats, times: NDArray[np.intp]) -> bool:
    """Whether a few values are not alike by rounding, and return often."""
    often = len(known) > 1 and times.sum() >= AGAIN * len(known) and bool(times[:2].min() >= OFTEN)
    return often and bool(np.diff(known).min() > PRECISION * np.abs(known).max())


def _grid(known: Floats) -> float:
    size = float(np.abs(known).max())
    fine = [g for g in GRIDS if g > PRECISION * size]
    for some in (known[:: -(-len(known) // 100)], known):  # a few first: values that are not rounded fit none
        fine = [g for g in fine if _on(some, g, size)]
    return max(_divided(known, PRECISION / 16 * size), *fine, 0.0)


def _on(known: Floats, step: float, size: float) -> bool:
    steps = (known - known[0]) / step
    return bool((np.abs(steps - np.rint(steps)) <= PRECISION / 16 * size / step).all())


def _divided(known: Floats, rounding: float) -> float:
    """The smallest gap divided by the smallest number for which every gap is a multiple: each that is none shows, as a
    fraction, a divisor of that number."""
    gaps = np.diff(known)
    gaps, parts = gaps[gaps > rounding], 1
    while len(gaps) and parts <= PARTS:
        step = float(gaps.min()) / parts
        times = gaps / step
        if step < SURE * rounding * (1.0 + times.max()):
            return 0.0
        off = np.flatnonzero(np.abs(times - np.rint(times)) * step > rounding * (1.0 + times))
        if not len(off):
            return float(f"{(known[-1] - known[0]) / np.rint((known[-1] - known[0]) / step):.{DIGITS}g}")
        parts *= max(Fraction(float(times[off].min())).limit_denominator(PARTS).denominator, 2)
    return 0.0
