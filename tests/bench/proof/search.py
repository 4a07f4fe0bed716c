"""Branch and bound over the unit cube of the uncertain parameters: a box is proved, or halved."""

from __future__ import annotations

import heapq
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bound = Callable[[Floats, Floats], tuple[float, int]]
"""(low, high) in the unit cube -> a lower bound of d_min or -1, and how many steps were proved."""

LONGEST = 1.4
"""Sides of a box worth trying, as multiples of the widest provable box about the centre."""


class Proof(NamedTuple):
    """Boxes proved, with their bounds, and (processor seconds, share proved, boxes tried) over the run."""

    low: Floats
    high: Floats
    bound: Floats
    curve: list[tuple[float, float, int]]


def widest(bound: Bound, way: Floats, tries: int = 8) -> float:
    """The widest provable box about the centre whose sides are multiples of `way`, by bisection: its factor."""
    low, high = 0.0, float(1.0 / way.max())
    for _ in range(tries):
        middle = 0.5 * (low + high)
        if bound(0.5 - 0.5 * middle * way, 0.5 + 0.5 * middle * way)[0] > 0.0:
            low = middle
        else:
            high = middle
    return low


def proved(bound: Bound, widths: Floats, seconds: float) -> Proof:
    """Prove as much of the cube as that processor time allows, largest box first.

    widths: of the widest provable box about the centre; a box is halved along the side that is longest measured by
    them, untried if that is longer than `LONGEST`.
    """
    began, tried, share = time.process_time(), 0, 0.0
    found, curve = [], [(0.0, 0.0, 0)]
    n = len(widths)
    heap = [(-1.0, 0, np.zeros(n), np.ones(n))]
    count = 1
    while heap and time.process_time() - began < seconds:
        negative, _, low, high = heapq.heappop(heap)
        sides = (high - low) / widths
        if sides.max() <= LONGEST:
            tried += 1
            value, _ = bound(low, high)
            if value > 0.0:
                found.append((low, high, value))
                share -= negative
                curve.append((time.process_time() - began, share, tried))
                continue
        i = int(np.argmax(sides))
        middle = 0.5 * (low[i] + high[i])
        for a, b in ((low[i], middle), (middle, high[i])):
            lower, upper = low.copy(), high.copy()
            lower[i], upper[i] = a, b
            heapq.heappush(heap, (0.5 * negative, count, lower, upper))
            count += 1
    curve.append((time.process_time() - began, share, tried))
    lows, highs, bounds = ([f[k] for f in found] for k in range(3))
    return Proof(np.array(lows).reshape(-1, n), np.array(highs).reshape(-1, n), np.array(bounds), curve)
