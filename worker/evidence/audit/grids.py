"""The step of which all differences of the stored values are multiples, found again: the coarsest that divides them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

DISTINCT, FINEST, BINARY = 5, 9, 30
"""Different values that lie on a grid at least; the finest one, in decimals and in binary digits."""
EPSILON = 2.0**-52


def step(costs: NDArray[np.float64]) -> float:
    """0 without one, of fewer than `DISTINCT` values, and of steps within their own rounding."""
    values = np.unique(costs)
    if len(values) < DISTINCT:
        return 0.0
    above, size = values[1:] - values[0], float(max(abs(values[0]), abs(values[-1])))
    for one in sorted(_steps(), reverse=True):
        if one <= 64 * EPSILON * size:
            return 0.0
        rest = np.remainder(above[:100], one)
        if (np.minimum(rest, one - rest) > 4 * EPSILON * size).any():
            continue
        rest = np.remainder(above, one)
        if (np.minimum(rest, one - rest) <= 4 * EPSILON * size).all():
            return one
    return 0.0


def _steps() -> Iterator[float]:
    for exponent in range(-FINEST, 4):
        yield from (float(f"{digits}e{exponent}") for digits in ("1", "2", "2.5", "5"))
    yield from (0.5**k for k in range(BINARY + 1))
