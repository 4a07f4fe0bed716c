"""One flight under DOP853, from instant to instant at which something jumps.

Between two instants the right-hand side is continuous in time and the guidance is held: each stretch begins with a
slope of its own, and no slope is taken beyond its end. Start reading at `fly`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from worker.reference.coefficients import STAGES
from worker.reference.reading import LOOKS, read
from worker.reference.stepper import (
    BARRED,
    BEGIN,
    COST,
    DRAW,
    GROW,
    KEPT,
    LIMIT,
    LOW,
    NEW,
    OLD,
    RATE,
    SAMPLE,
    SAVED,
    SEEN,
    SLOPE,
    K,
    X,
    call,
    factor,
    guessed,
    stages,
)

RELATIVE = ABSOLUTE = 1e-10
"""Tolerances of a step. Measured on two aircraft campaigns: d_min is within 5e-9 of what 1e-12 and 1e-14 give."""

COARSE = 1e-4
"""Both tolerances from where the fine ones make no headway: a loop that slides along a switch has no order there."""

HEADWAY = 1e-3
"""So many calls of the right-hand side as `patience` allows for less than this fraction of the horizon: no headway."""

OK, NOT_FINITE, EXCLUDED, OUTSIDE = 0.0, 1.0, 2.0, 3.0
"""As in the loop that flies in lockstep; OUTSIDE + k is limit k of the vehicle's envelope."""
STUCK, SHORT = -1.0, -2.0
"""The loop switches without end; the step that the tolerance asks for is shorter than the spacing of numbers."""

LARGEST, FARTHEST = 1e12, 1e300
"""The sum of magnitudes of the states, and the magnitude of a channel, beyond which a flight has diverged."""

SPACINGS = 10.0
"""The shortest step, in spacings of the numbers around the time."""


STEP, CALLS, MARK, WHEN = range(4)
"""What a flight carries on, in c: the next step [s]; calls since its headway was looked at, and when that was [s]; the
time [s]."""


def fly(
    system: Any, instants: Any, asks: Any, before: float, patience: int, b: Any, y: Any, p: Any, c: Any, found: Any
) -> None:
    """Fly a system through the stretches between n + 1 instants [s].

    asks (n,): whether guidance is sampled at a stretch's start; before: by which fraction of it the end of each is
    approached; patience: calls of the right-hand side without headway; b, y, c: room to work in, (ROWS, states),
    (CHANNEL_ROWS, channels) and (4,); p: the system's parameters. Out: found (6,) as the criterion's value; a status as
    above; the time it ended [s]; from when it was flown at the coarse tolerance [s], why (STUCK or SHORT, else 0), and
    when that was found [s].
    """
    call(system, DRAW, (instants[0] + instants[1]) / 2.0, b, X, X, y, p)
    code = begun(instants[0], system, b, y, p, c)
    relative, floor = RELATIVE, ABSOLUTE
    horizon = instants[len(instants) - 1]
    for k in range(len(instants) - 1):
        if code != OK:
            break
        start, end = instants[k], instants[k + 1]
        if k > 0:
            # In the middle: an end may be a switch but for rounding, or a sample of guidance next to one.
            call(system, DRAW, (start + end) / 2.0, b, X, X, y, p)
        if asks[k] and k > 0:
            call(system, SAMPLE, start, b, X, X, y, p)
        until = end - before * (end - start)
        for i in range(b.shape[1]):
            b[SAVED, i] = b[X, i]
        for i in range(y.shape[1]):
            y[KEPT, i] = y[LOW, i]
        code = stretch(start, end, until, relative, floor, horizon, patience, system, b, y, p, c)
        if code < OK and relative < COARSE:
            relative = floor = COARSE
            found[3], found[4], found[5] = start, code, c[WHEN]
            for i in range(b.shape[1]):
                b[X, i] = b[SAVED, i]
            for i in range(y.shape[1]):
                y[LOW, i] = y[KEPT, i]
            c[STEP], c[CALLS], c[MARK] = 0.0, 0.0, start
            code = stretch(start, end, until, relative, floor, horizon, patience, system, b, y, p, c)
    for i in range(y.shape[1]):
        y[SEEN, i] = y[LOW, i]
    found[0] = call(system, COST, c[WHEN], b, X, X, y, p)
    found[1] = code
    found[2] = c[WHEN]


def begun(start: float, system: Any, b: Any, y: Any, p: Any, c: Any) -> float:
    """The state, the first guidance sample and the channels at the start; the status there."""
    call(system, BEGIN, start, b, X, X, y, p)
    call(system, SAMPLE, start, b, X, X, y, p)
    call(system, SLOPE, start, b, X, K, y, p)
    for i in range(y.shape[1]):
        y[OLD, i] = y[SEEN, i]
        y[LOW, i], y[RATE, i] = math.inf, 0.0
    c[STEP], c[CALLS], c[MARK], c[WHEN] = 0.0, 0.0, start, start
    code = judged(start, system, b, y, p)
    if code == OK and call(system, BARRED, start, b, X, X, y, p) > 0.0:
        return EXCLUDED
    return code


def judged(t: float, system: Any, b: Any, y: Any, p: Any) -> float:
    """OK, NOT_FINITE or OUTSIDE + k: decided from the state and the channels at OLD, never from the cost."""
    total = highest = 0.0
    for i in range(b.shape[1]):
        total += abs(b[X, i])
    for i in range(y.shape[1]):
        highest += abs(y[OLD, i])
    if not (total < LARGEST and highest < FARTHEST):
        return NOT_FINITE
    limit = call(system, LIMIT, t, b, X, X, y, p)
    return OUTSIDE - 1.0 + limit if limit > 0.0 else OK


def stretch(
    start: float, end: float, until: float, rel: float, floor: float, horizon: float, patience: int, system: Any,
    b: Any, y: Any, p: Any, c: Any,
) -> float:  # fmt: skip
    """Step from start to end, reading the channels; the status, with the time at WHEN."""
    t = start
    call(system, SLOPE, t, b, X, K, y, p)
    for i in range(y.shape[1]):
        y[OLD, i] = y[SEEN, i]
        y[LOW, i] = min(y[LOW, i], y[SEEN, i])
    if c[STEP] == 0.0:
        c[STEP] = guessed(rel, floor, b)
    most, left = GROW, 2.0
    while left > 1.0:
        c[WHEN] = t
        # What is left in equal steps: the last is not a splinter.
        left = max(1.0, math.ceil(min((end - t) / c[STEP], 1e15)))
        h = (end - t) / left
        if not h > SPACINGS * np.spacing(t):
            return SHORT
        if c[CALLS] >= patience:
            if t - c[MARK] < HEADWAY * horizon:
                return STUCK
            c[CALLS], c[MARK] = 0.0, t
        c[CALLS] += STAGES
        error = stages(t, h, 1, STAGES + 1, until, rel, floor, system, b, y, p)
        longer = factor(error)
        if not error < 1.0:
            c[STEP], most, left = h * min(1.0, longer), 1.0, 2.0
            continue
        # A step that could be much longer, cut short by the end, tells nothing of the one that was meant.
        c[STEP] = h * min(most, longer) if longer < GROW else max(c[STEP], h * most)
        most = GROW
        read(t, h, until, horizon / LOOKS, system, b, y, p)
        for i in range(b.shape[1]):
            b[X, i] = b[NEW, i]
            b[K, i] = b[K + STAGES, i]
        t = end if left == 1.0 else t + h
        c[WHEN] = t
        code = judged(t, system, b, y, p)
        if code != OK:
            return code
    return OK
