"""The step of which all differences of the stored values are multiples, found again: the coarsest that divides them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

DISTINCT, FINEST, BINARY = 5, 9, 30
"""Different values that lie on a grid at least; the finest one, in decimals and in binary digits."""
OFTEN, EACH = 20, 5
"""So many evaluations for each of fewer values show one as well, if the two lowest have so many at least."""
NEAREST = 100, 30, 10
"""Of so many of the lowest values the step counts."""
EPSILON = 2.0**-52
OWN = 0.999
"""A step is that of the values if it is this fraction of a gap."""
PARTS, CERTAIN = 100, 1024
"""Any other step is this part of the smallest gap at least, and so many times what is rounding."""


def step(costs: NDArray[np.float64], any_step: bool, lowest: Sequence[int] = NEAREST, few: bool = True) -> float:
    """0 without one, of fewer than `DISTINCT` values that do not return often, and of steps within their own rounding;
    the lowest gap of values that return often and that no step of this size divides.

    any_step: whether steps other than decimal and binary ones count; lowest: of how many of the lowest values the step
    of their own counts, if it is larger; few: whether values count, fewer or on no grid, if they return often.
    """
    values, counts = np.unique(costs, return_counts=True)
    if len(values) < DISTINCT and not (few and _returning(values, counts)):
        return 0.0
    found = max(_of(some, any_step) for some in (values, *(values[:count] for count in lowest)))
    some, times = values[:DISTINCT], counts[:DISTINCT]
    if not (few and _returning(some, times)) or (len(some) == DISTINCT and min(times) < EACH):
        return found
    return found if any(found >= OWN * (b - a) for a, b in pairwise(some)) else float(some[1] - some[0])


def _returning(values: NDArray[np.float64], counts: NDArray[np.intp]) -> bool:
    if len(values) < 2 or counts.sum() < OFTEN * len(values) or min(counts[0], counts[1]) < EACH:
        return False
    return bool(np.diff(values).min() > 64 * EPSILON * max(abs(values[0]), abs(values[-1])))


def _of(values: NDArray[np.float64], any_step: bool) -> float:
    above, size = values[1:] - values[0], float(max(abs(values[0]), abs(values[-1])))
    return max(_usual(above, size), _part(np.diff(values), float(above[-1]), 4 * EPSILON * size) if any_step else 0.0)


def _usual(above: NDArray[np.float64], size: float) -> float:
    for one in sorted(_steps(), reverse=True):
        if one <= 64 * EPSILON * size:
            return 0.0
        if all(_rest(some, one).max() <= 4 * EPSILON * size for some in (above[:100], above)):
            return one
    return 0.0


def _part(gaps: NDArray[np.float64], span: float, least: float) -> float:
    """The largest of the whole parts of the smallest gap that divides all of them; `least` is rounding."""
    between = np.sort(gaps[gaps > least])
    for part in range(1, PARTS + 1) if len(between) else ():
        one = between[0] / part
        if one < CERTAIN * least * (1 + between[-1] / one):
            return 0.0
        if all((_rest(some, one) <= least * (1 + some / one)).all() for some in (between[:100], between)):
            return float(f"{span / round(span / one):.12g}")
    return 0.0


def _rest(lengths: NDArray[np.float64], one: float) -> NDArray[np.float64]:
    """How far each is from a multiple."""
    rest = np.remainder(lengths, one)
    return np.minimum(rest, one - rest)


def _steps() -> Iterator[float]:
    for exponent in range(-FINEST, 4):
        yield from (float(f"{digits}e{exponent}") for digits in ("1", "2", "2.5", "5"))
    yield from (0.5**k for k in range(BINARY + 1))
