"""One simulation with DOP853, in stretches between the instants of discontinuities.

Within a stretch the right-hand side is continuous in time and the guidance is held. Every stretch starts with a new
slope, and no slope is evaluated beyond its end.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from worker.engine.reference.coefficients import STAGES
from worker.engine.reference.reading import READINGS, read
from worker.engine.reference.stepper import (
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

RELATIVE = ABSOLUTE = 1e-9
"""Tolerances of a step. Measured on three aircraft campaigns: d_min is within 1.5e-6 m of its value at 1e-13; with
measurements that drop out at random instants it was 4e-6 m from that of SciPy's integrator with the same tolerances."""

COARSE = 1e-4
"""Both tolerances once the fine ones make no progress, as in a loop that chatters along a switching surface."""

LENIENT = 3
"""The coarse tolerance has this many times the patience of the fine one: nothing comes after it."""

HEADWAY = 1e-3
"""The smallest progress, as a fraction of the horizon, within `patience` calls of the right-hand side."""

OK, NOT_FINITE, EXCLUDED, OUTSIDE = 0.0, 1.0, 2.0, 3.0
"""As in the lockstep loop; OUTSIDE + k is limit k of the vehicle's envelope."""
STUCK, SHORT = -1.0, -2.0
"""The loop chatters; the step size that the tolerance requires is below the floating-point spacing of time."""

LARGEST, FARTHEST = 1e12, 1e300
"""A simulation has diverged when the sum of the absolute values of its states, or of its channels, exceeds these."""

SPACINGS = 10.0
"""The shortest step, in multiples of the floating-point spacing at the current time."""

ABOUT_TURNS = 20
"""The smallest number of samples of the channels in a stretch at either end of which an obstacle turns or stops."""

STEP, CALLS, MARK, WHEN, LOOK = range(5)
"""Elements of c, the state of the step control: next step [s]; calls since the last check of progress, and its time
[s]; current time [s]; the longest interval between two looks at the channels [s]."""


def fly(
    system: Any, instants: Any, asks: Any, turns: Any, before: float, patience: int, b: Any, y: Any, p: Any, c: Any,
    found: Any,
) -> None:  # fmt: skip
    """Simulate a system through the stretches between n + 1 instants [s].

    asks (n,): whether guidance is sampled at the start of each stretch; turns (n,): whether an obstacle turns or stops
    at either end of it; before: fraction of a stretch by which slopes stay before its end; patience: calls of the
    right-hand side without progress; b, y, c: work arrays (ROWS, states), (CHANNEL_ROWS, channels) and (5,); p: the
    system's parameters. Out: found (6,): the criterion's value; a status as above; the end time [s]; the time from
    which the coarse tolerance was used [s], why (STUCK or SHORT, else 0), and the time at which that was detected [s].
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
            # Drawn at the midpoint, because rounding can put an end of the stretch on the wrong side of a switch.
            call(system, DRAW, (start + end) / 2.0, b, X, X, y, p)
        if asks[k] and k > 0:
            call(system, SAMPLE, start, b, X, X, y, p)
        until = end - before * (end - start)
        for i in range(b.shape[1]):
            b[SAVED, i] = b[X, i]
        for i in range(y.shape[1]):
            y[KEPT, i] = y[LOW, i]
        spacing = min(horizon / READINGS, c[LOOK])
        if turns[k]:
            spacing = min(spacing, (end - start) / ABOUT_TURNS)
        code = stretch(start, end, until, relative, floor, horizon, patience, spacing, turns[k], system, b, y, p, c)
        if code < OK and relative < COARSE:
            relative = floor = COARSE
            found[3], found[4], found[5] = start, code, c[WHEN]
            for i in range(b.shape[1]):
                b[X, i] = b[SAVED, i]
            for i in range(y.shape[1]):
                y[LOW, i] = y[KEPT, i]
            c[STEP], c[CALLS], c[MARK] = 0.0, 0.0, start
            patience *= LENIENT
            code = stretch(start, end, until, relative, floor, horizon, patience, spacing, turns[k], system, b, y, p, c)
    for i in range(y.shape[1]):
        y[SEEN, i] = y[LOW, i]
    found[0] = call(system, COST, c[WHEN], b, X, X, y, p)
    found[1] = code
    found[2] = c[WHEN]


def begun(start: float, system: Any, b: Any, y: Any, p: Any, c: Any) -> float:
    """Set the state, the first guidance sample and the channels at the start; returns the status there."""
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
    """OK, NOT_FINITE or OUTSIDE + k, from the state and the channels at OLD, never from the cost."""
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
    start: float, end: float, until: float, rel: float, floor: float, horizon: float, patience: int, spacing: float,
    turns: bool, system: Any, b: Any, y: Any, p: Any, c: Any,
) -> float:  # fmt: skip
    """Step from start to end and update the channels; returns the status, with the time at WHEN.

    spacing: that of the samples of the channels [s]; turns: whether every step is sampled.
    """
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
        # Divide the rest into equal steps, so that the last one is not tiny.
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
        # A step cut short by the end of the stretch does not limit the next step size if its error is far below 1.
        c[STEP] = h * min(most, longer) if longer < GROW else max(c[STEP], h * most)
        most = GROW
        read(t, h, until, spacing, turns or h > c[LOOK], system, b, y, p)
        for i in range(b.shape[1]):
            b[X, i] = b[NEW, i]
            b[K, i] = b[K + STAGES, i]
        t = end if left == 1.0 else t + h
        c[WHEN] = t
        code = judged(t, system, b, y, p)
        if code != OK:
            return code
    return OK
