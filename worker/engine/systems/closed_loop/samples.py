"""What places at equal intervals of time show of the path through them, in compiled code.

A path that turns fast has tens of thousands of places, and a run follows one for every flight that it continues.
"""

from __future__ import annotations

from math import inf, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels.cached import compiled
from worker.engine.systems.base import Floats


@compiled
def ends(places: Floats) -> Floats:
    """The smallest and the largest coordinates (2, 3) of places (m, 3); NaN of those that have one."""
    found = np.empty((2, 3))
    for k in range(3):
        low, high = inf, -inf
        for i in range(len(places)):
            at = places[i, k]
            if at < low or at != at:
                low = at
            if at > high or at != at:
                high = at
        found[0, k], found[1, k] = low, high
    return found


@compiled
def relative(places: Floats, times: Floats, position: Floats, velocity: Floats, lasts: float) -> Floats:
    """The places (m, 3) at some times [s] as seen from what starts at a position (3,), and goes on for a while."""
    found = np.empty((len(places), 3))
    for i in range(len(places)):
        gone = times[i] if times[i] < lasts else lasts
        for k in range(3):
            found[i, k] = places[i, k] - position[k] - gone * velocity[k]
    return found


@compiled
def lengths(vectors: Floats) -> Floats:
    """Those of vectors (m, 3)."""
    found = np.empty(len(vectors))
    for i in range(len(vectors)):
        square = 0.0
        for k in range(3):
            square += vectors[i, k] * vectors[i, k]
        found[i] = sqrt(square)
    return found


@compiled
def bends(places: Floats) -> Floats:
    """The second difference (m,) at every inner one of places (m >= 3, 3); at either end twice that beside it."""
    last = len(places) - 1
    found = np.empty(last + 1)
    for i in range(1, last):
        square = 0.0
        for k in range(3):
            bent = (places[i + 1, k] - places[i, k]) - (places[i, k] - places[i - 1, k])
            square += bent * bent
        found[i] = sqrt(square)
    found[0], found[last] = 2.0 * found[1], 2.0 * found[last - 1]
    return found


@compiled
def nearest(places: Floats) -> Floats:
    """The least distance from the origin within every interval (m - 1,) of places (m >= 3, 3): that of its chord, less
    what the path may deviate from it, at a corner, too: half of the larger one of the bends at its ends."""
    bent = bends(places)
    found = np.empty(len(places) - 1)
    for i in range(len(places) - 1):
        square, along = 0.0, 0.0
        for k in range(3):
            step = places[i + 1, k] - places[i, k]
            square += step * step
            along += places[i, k] * step
        at = -along / (square if square > 0.0 else 1.0)
        at = 0.0 if at < 0.0 else (1.0 if at > 1.0 else at)
        chord = 0.0
        for k in range(3):
            x = places[i, k] + at * (places[i + 1, k] - places[i, k])
            chord += x * x
        larger = bent[i] if bent[i] > bent[i + 1] or bent[i] != bent[i] else bent[i + 1]
        found[i] = sqrt(chord) - 0.5 * larger
    return found


@compiled
def least(values: Floats, count: int) -> tuple[Floats, NDArray[np.int64]]:
    """The smallest values (count,), in their order, and where they are; of equal ones the first. What has no value is
    left out, and NaN stands for what there is not."""
    found, at = np.full(count, nan), np.zeros(count, np.int64)
    size = 0
    for i in range(len(values)):
        value = values[i]
        if value != value or (size == count and not value < found[count - 1]):
            continue
        k = size if size < count else count - 1
        while k > 0 and value < found[k - 1]:
            found[k], at[k] = found[k - 1], at[k - 1]
            k -= 1
        found[k], at[k] = value, i
        size = min(size + 1, count)
    return found, at
