"""One step of DOP853: slopes, error estimate and dense output.

Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sections II.4 to II.6 and II.10. Rows of b
(ROWS, n): X the state at the start of the step, NEW at its end, WORK at a stage, K the slopes, F the dense output.
`compiled` compiles these plain functions once for all systems.
"""

from __future__ import annotations

import math
from typing import Any

from worker.engine.reference.coefficients import ALL, E3, E5, STAGES, A, C, D

X, NEW, WORK, SAVED, K = range(5)
F = K + ALL
ROWS = F + 7
"""Rows of b (ROWS, n)."""

SEEN, OLD, END, LEFT, MID, RIGHT, LOW, KEPT, RATE = range(9)
CHANNEL_ROWS = 9
"""Rows of y (CHANNEL_ROWS, m): SEEN the channels at the last slope; the others belong to `reading`."""

SLOPE, BEGIN, SAMPLE, BARRED, LIMIT, COST, DRAW, SEE = range(8)
"""Requests to a system, see `call`."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0
"""Safety factor of the step control, and the limits of the ratio of successive steps."""


def call(system: Any, what: int, t: float, b: Any, at: int, to: int, y: Any, p: Any) -> float:
    """Call the system, a function of (what, t, x, dx, channels, p), or its address in compiled code.

    SLOPE: the slope dx and the channels from the state x; SEE: only the channels; BEGIN: the initial state x; SAMPLE: a
    guidance sample, stored in p; BARRED: whether the channels exclude the simulation; LIMIT: the number of the limit
    that x exceeds, else 0; COST: the cost from the channels; DRAW: the noise of the stretch, stored in p.
    """
    return system(what, t, b[at], b[to], y[SEEN], p)  # type: ignore[no-any-return]


def stages(
    t: float, h: float, first: int, beyond: int, until: float, rel: float, floor: float, system: Any, b: Any, y: Any,
    p: Any,
) -> float:  # fmt: skip
    """Slopes `first` up to but not including `beyond` of a step from t; returns the error, below 1 if it is accepted.

    The thirteenth slope, at the new state, is evaluated only for an accepted step. No slope is evaluated later than
    `until`. rel, floor: relative and absolute tolerance.
    """
    n = b.shape[1]
    error = 0.0
    for s in range(first, beyond):
        added(A[s], s, b, WORK)
        for i in range(n):
            b[WORK, i] = b[X, i] + h * b[WORK, i]
        if s == STAGES:
            error = estimated(h, rel, floor, b)
            if not error < 1.0:
                return error
            for i in range(n):
                b[NEW, i] = b[WORK, i]
        call(system, SLOPE, min(t + C[s] * h, until), b, WORK, K + s, y, p)
    return error


def added(weights: Any, slopes: int, b: Any, to: int) -> None:
    """The weighted sum of the first `slopes` slopes, row by row, so that it vectorises over the states."""
    for i in range(b.shape[1]):
        b[to, i] = 0.0
    for j in range(slopes):
        weight = weights[j]
        if weight != 0.0:
            for i in range(b.shape[1]):
                b[to, i] += weight * b[K + j, i]


def estimated(h: float, rel: float, floor: float, b: Any) -> float:
    """The error of a step to the state at WORK over the tolerance, from both embedded solutions (section II.10)."""
    added(E5, STAGES, b, F)
    added(E3, STAGES, b, F + 1)
    five = three = 0.0
    for i in range(b.shape[1]):
        scale = floor + rel * max(abs(b[X, i]), abs(b[WORK, i]))
        five += (b[F, i] / scale) ** 2
        three += (b[F + 1, i] / scale) ** 2
    below = five + 0.01 * three
    # NaN propagates, and a step with a NaN error is rejected.
    return abs(h) * five / math.sqrt(below * b.shape[1]) if below != 0.0 else 0.0


def factor(error: float) -> float:
    """The ratio of the next step to one with this error."""
    if error == 0.0:
        return GROW
    if not error < 1e300:
        return SHRINK
    return min(GROW, max(SHRINK, SAFETY * error**-0.125))  # type: ignore[no-any-return]


def guessed(rel: float, floor: float, b: Any) -> float:
    """The initial step: an Euler step with the slope at K changes the state by 1 % (section II.4)."""
    size = speed = 0.0
    for i in range(b.shape[1]):
        scale = floor + rel * abs(b[X, i])
        size += (b[X, i] / scale) ** 2
        speed += (b[K, i] / scale) ** 2
    if size < 1e-10 or speed < 1e-10:
        return 1e-6
    return max(0.01 * math.sqrt(size / speed), 1e-15)


def bend(h: float, b: Any) -> None:
    """Compute the dense output of a step from all its slopes."""
    for i in range(b.shape[1]):
        change = b[NEW, i] - b[X, i]
        old, new = b[K, i], b[K + STAGES, i]
        b[F, i] = change
        b[F + 1, i] = h * old - change
        b[F + 2, i] = 2.0 * change - h * (new + old)
    for r in range(3, 7):
        added(D[r - 3], ALL, b, F + r)
        for i in range(b.shape[1]):
            b[F + r, i] *= h


def between(fraction: float, b: Any) -> None:
    """The state at this fraction of the step, at WORK."""
    rest = 1.0 - fraction
    for i in range(b.shape[1]):
        y = (b[F + 6, i] * fraction + b[F + 5, i]) * rest
        y = ((y + b[F + 4, i]) * fraction + b[F + 3, i]) * rest
        y = ((y + b[F + 2, i]) * fraction + b[F + 1, i]) * rest
        b[WORK, i] = b[X, i] + (y + b[F, i]) * fraction
