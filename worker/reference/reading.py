"""The lowest value of every channel within one step, from the dense output.

Channels are read at the ends of a step and at instants between them; a sample that is lower than both of its
neighbours is followed down by golden sections (Kiefer 1953). Start reading at `read`.
"""

from __future__ import annotations

import math
from typing import Any

from worker.reference.stepper import (
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

LOOKS = 2000
"""Instants of a flight at which the channels are read before each minimum is refined, besides the ends of steps."""

EDGE = 1e-3
"""Next to the ends of a step the channels are read again, this fraction of the spacing inside: is one falling there?"""

REACH = 4.0
"""A step is read inside only where a channel could get below its lowest value so far if it changed this many times
faster than it did, on average, over any step until now."""

GOLDEN = 0.6180339887498949
NARROW = 1e-9
"""The width to which the interval around a minimum is narrowed [s]."""
ROUNDING = 1e-12
"""A minimum is refined only where it may be lower than the lowest value so far by more than this fraction of it."""


def read(t: float, h: float, until: float, spacing: float, system: Any, b: Any, y: Any, p: Any) -> None:
    """Lower LOW to the lowest values within the step just taken; OLD and SEEN hold the channels at its ends."""
    near = False
    for i in range(y.shape[1]):
        old, new = y[OLD, i], y[SEEN, i]
        y[RATE, i] = max(y[RATE, i], abs(new - old) / h)
        near |= not min(old, new) - REACH * h * y[RATE, i] > y[LOW, i]
        y[LOW, i] = min(y[LOW, i], new)
        y[END, i] = new
    if near:
        look(t, h, until, spacing, system, b, y, p)
    for i in range(y.shape[1]):
        y[OLD, i] = y[END, i]


def look(t: float, h: float, until: float, spacing: float, system: Any, b: Any, y: Any, p: Any) -> None:
    """Read the dense output of the step at so many instants, and refine every minimum among them."""
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
            rise = max(y[LEFT, i], y[RIGHT, i]) - here
            lowest = here <= y[LEFT, i] and here <= y[RIGHT, i]
            if k > 0 and lowest and here - rise < y[LOW, i] - ROUNDING * abs(y[LOW, i]):
                refine(t, h, left, right, until, i, system, b, y, p)
        for i in range(y.shape[1]):
            y[LEFT, i], y[MID, i] = y[MID, i], y[RIGHT, i]
        left, mid = mid, right


def refine(
    t: float, h: float, left: float, right: float, until: float, i: int, system: Any, b: Any, y: Any, p: Any
) -> None:
    """Golden sections on channel i between two fractions of the step; every value seen counts."""
    one, other = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
    at_one = at_other = math.inf
    known = 0
    while True:
        # Of two inner points the one that is left over from the interval before is known already.
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
