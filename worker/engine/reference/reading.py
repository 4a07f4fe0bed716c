"""The lowest value of every channel within one step, from the dense output.

Channels are sampled at the ends of a step and in between; a sample lower than both of its neighbours is refined by
golden section search (Kiefer 1953).
"""

from __future__ import annotations

import math
from typing import Any

from worker.engine.reference.stepper import (
    END,
    LEFT,
    LOW,
    MID,
    OLD,
    RATE,
    RIGHT,
    SEE,
    SEEN,
    WORK,
    bend,
    between,
    call,
    stages,
)

READINGS = 2000
"""Samples of the channels over the horizon, besides the ends of steps, before minima are refined."""

EDGE = 1e-3
"""Extra samples at this fraction of the spacing inside the ends of a step detect a channel that decreases there."""

REACH = 4.0
"""The inside of a step is sampled only if a channel could fall below its lowest value so far when changing this many
times faster than its highest average rate over any step."""

GOLDEN = 0.6180339887498949
NARROW = 1e-9
"""The final width of the interval around a minimum [s]."""
ROUNDING = 1e-12
"""A minimum is refined only if it could improve on the lowest value so far by more than this fraction."""


def read(t: float, h: float, until: float, spacing: float, turns: bool, system: Any, b: Any, y: Any, p: Any) -> None:
    """Update LOW with the lowest values within the last step; OLD and SEEN hold the channels at its ends.

    turns: whether an obstacle may turn so far within the step, or just before or after it, that its ends say nothing
    about its inside.
    """
    near = turns
    for i in range(y.shape[1]):
        old, new = y[OLD, i], y[SEEN, i]
        y[RATE, i] = max(y[RATE, i], abs(new - old) / h)
        near |= not min(old, new) - REACH * h * y[RATE, i] > y[LOW, i]
        y[LOW, i] = min(y[LOW, i], new)
        y[END, i] = new
    if near:
        sample(t, h, until, spacing, system, b, y, p)
    for i in range(y.shape[1]):
        y[OLD, i] = y[END, i]


def sample(t: float, h: float, until: float, spacing: float, system: Any, b: Any, y: Any, p: Any) -> None:
    """Sample the dense output of the step at this spacing, and refine every minimum."""
    stages(t, h, 13, 16, until, 1.0, 1.0, system, b, y, p)
    bend(h, b)
    pieces = math.ceil(min(h / spacing, 1e6))
    edge = EDGE / pieces
    left = mid = 0.0
    for i in range(y.shape[1]):
        y[LEFT, i] = y[MID, i] = y[OLD, i]
    for k in range(pieces + 2):
        right = k / pieces
        if k == 0:
            right = edge
        elif k == pieces:
            right = 1.0 - edge
        elif k > pieces:
            right = 1.0
        if k <= pieces:
            seen_at(t, h, right, until, system, b, y, p)
        for i in range(y.shape[1]):
            y[RIGHT, i] = y[SEEN, i] if k <= pieces else y[END, i]
            y[LOW, i] = min(y[LOW, i], y[RIGHT, i])
        for i in range(y.shape[1]):
            here = y[MID, i]
            lowest = k > 0 and here <= y[LEFT, i] and here <= y[RIGHT, i]
            if lowest and here - fall(left, mid, right, i, y) < y[LOW, i] - ROUNDING * abs(y[LOW, i]):
                refine(t, h, left, right, until, i, system, b, y, p)
        for i in range(y.shape[1]):
            y[LEFT, i], y[MID, i] = y[MID, i], y[RIGHT, i]
        left, mid = mid, right


def fall(left: float, mid: float, right: float, i: int, y: Any) -> float:
    """How far a convex channel can fall below its middle sample: as far as the lines through either pair extend.

    Beside an end of the step the samples are EDGE apart, so the other interval is far longer.
    """
    before, after = mid - left, right - mid
    return max((y[LEFT, i] - y[MID, i]) * after / before, (y[RIGHT, i] - y[MID, i]) * before / after)  # type: ignore[no-any-return]


def refine(
    t: float, h: float, left: float, right: float, until: float, i: int, system: Any, b: Any, y: Any, p: Any
) -> None:
    """Golden section search on channel i between two fractions of the step; all sampled values update LOW."""
    one, other = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
    at_one = at_other = math.inf
    known = 0
    while True:
        # One of the two inner points is known from the previous interval.
        if known != 1:
            seen_at(t, h, one, until, system, b, y, p)
            at_one = y[SEEN, i]
        if known == 1 or known == 0:
            seen_at(t, h, other, until, system, b, y, p)
            at_other = y[SEEN, i]
        y[LOW, i] = min(y[LOW, i], at_one, at_other)
        if not (right - left) * h > NARROW:
            return
        if at_one < at_other:
            right, other, at_other, known = other, one, at_one, 2
            one = right - GOLDEN * (right - left)
        else:
            left, one, at_one, known = one, other, at_other, 1
            other = left + GOLDEN * (right - left)


def seen_at(t: float, h: float, fraction: float, until: float, system: Any, b: Any, y: Any, p: Any) -> None:
    """The channels at this fraction of the step, at SEEN."""
    between(fraction, b)
    call(system, SEE, min(t + fraction * h, until), b, WORK, WORK, y, p)
