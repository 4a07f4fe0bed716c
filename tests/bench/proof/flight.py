"""One flight of a whole box of parameters: the steps of worker/engine/kernels/loop.py over rows."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tests.bench.proof.frame import reframed
from tests.bench.proof.functions import (
    absolute,
    angle,
    chosen,
    firas,
    frozen,
    largest,
    limited,
    recip,
    root,
    sincos,
    wrapped,
)
from tests.bench.proof.rows import (
    LINEAR,
    UP,
    born,
    bounds,
    combine,
    constant,
    copy,
    jit,
    lin1,
    lin2,
    lin3,
    mul,
    parameter,
    square,
)
from tests.bench.proof.traced import (
    ABS,
    ANGLE,
    BORN,
    CHOOSE,
    FIRAS,
    FREEZE,
    LIMIT,
    LIN1,
    LIN2,
    MAX,
    MUL,
    RECIP,
    ROOT,
    SINCOS,
    SQUARE,
    TURN,
    WRAP,
)


class Code(NamedTuple):
    """A program, and where its results are."""

    codes: Any
    constants: Any
    out: Any


class Plan(NamedTuple):
    """A closed loop over rows: t, parameters, states and guidance as they enter a program, temporaries; then the states
    and the guidance of the step."""

    extend: Code
    initial: Code
    guide: Code
    slope: Code
    seen: Code
    n_p: int
    n_x: int
    n_g: int
    n_y: int
    births: int
    rows: int
    step: float
    steps: int
    every: int
    limits: Any
    """(n_x, 2): the envelope; a flight that leaves it has no result."""
    slip: int
    """The state whose size the next two must stay below, or -1."""


@jit
def run(w, codes, constants, fresh, s):
    """Do the operations on the table w; the last three rows are to work in."""
    a, b = w.shape[0] - 1, w.shape[0] - 2
    for i in range(codes.shape[0]):
        op, o, x, y, z, o2 = codes[i]
        p, q, k = constants[i]
        if op == LIN2:
            lin2(w, o, p, x, q, y, k)
        elif op == MUL:
            mul(w, o, x, y, s)
        elif op == LIN1:
            lin1(w, o, p, x, k)
        elif op == SQUARE:
            square(w, o, x, s)
        elif op == RECIP:
            recip(w, o, x, s)
        elif op == ROOT:
            root(w, o, x, s)
        elif op == SINCOS:
            sincos(w, o, o2, x, s)
        elif op in (ANGLE, TURN):
            angle(w, o, x, y, a, b, op == TURN, s)
        elif op == ABS:
            absolute(w, o, x, s)
        elif op == MAX:
            largest(w, o, x, y, a, s)
        elif op == LIMIT:
            limited(w, o, x, p, q, a, b, s)
        elif op == CHOOSE:
            chosen(w, o, x, y, z, a, s)
        elif op == FREEZE:
            frozen(w, o, x, y, z, p, q, a, s)
        elif op == WRAP:
            wrapped(w, o, x, s)
        elif op == FIRAS:
            firas(w, o, x, p, s)
        elif op == BORN:
            born(w, o, fresh + x, s)


@jit
def slopes(w, code, k, at, count, fresh, s):
    """Run a program on the states at row `at`, and copy its first `count` results to k."""
    run(w, code.codes, code.constants, fresh, s)
    for j in range(count):
        copy(w, k + j, code.out[j])


@jit
def begun(w, plan, low, high, s):
    """The parameters' rows and the state at the start."""
    first = np.zeros((plan.rows, s.width))
    for i in range(len(low)):
        if low[i] == high[i]:
            constant(first, 1 + i, low[i])
        else:
            parameter(first, 1 + i, i, low[i], high[i])
    constant(first, 0, 0.0)
    run(first, plan.extend.codes, plan.extend.constants, 0, s)
    constant(w, 0, 0.0)
    for j in range(plan.n_p):
        w[1 + j, :] = first[plan.extend.out[j], :]
    run(w, plan.initial.codes, plan.initial.constants, 0, s)


@jit
def stepped(w, plan, i, X, s):
    """One step from the states at X, as flown; the rows of the channels are left where `seen` puts them."""
    n, m, dt = plan.n_x, plan.n_x + plan.n_g, plan.step
    XS = 1 + plan.n_p
    K = X + m
    t = i * dt
    constant(w, 0, t)
    for j in range(m):
        copy(w, XS + j, X + j)
    if plan.n_g > 0 and i % plan.every == 0:
        run(w, plan.guide.codes, plan.guide.constants, 0, s)
        for j in range(plan.n_g):
            copy(w, X + n + j, plan.guide.out[j])
            # the held demand's remainder is one number for the whole sample
            born(w, X + n + j, 4 * plan.births + j, s)
        for j in range(m):
            copy(w, XS + j, X + j)
    slopes(w, plan.seen, K, XS, n + plan.n_y, 0, s)


@jit
def advanced(w, plan, i, X, s):
    """The three other slopes and the step itself."""
    n, m, dt = plan.n_x, plan.n_x + plan.n_g, plan.step
    XS, K = 1 + plan.n_p, X + m
    at = (0.0, 0.5 * dt, 0.5 * dt, dt * (1.0 - 1e-8))
    width = (0.0, 0.5 * dt, 0.5 * dt, dt)
    to = K + n + plan.n_y
    before = K
    for stage in range(1, 4):
        constant(w, 0, i * dt + at[stage])
        for j in range(n):
            lin2(w, XS + j, 1.0, X + j, width[stage], before + j, 0.0)
        for j in range(plan.n_g):
            copy(w, XS + n + j, X + n + j)
        slopes(w, plan.slope, to, XS, n, stage * plan.births, s)
        before = to
        to += n
    k2 = K + n + plan.n_y
    for j in range(n):
        combine(w, X + j, X + j, dt / 6.0, K + j, k2 + j, k2 + n + j, k2 + 2 * n + j)


@jit
def inside(w, plan, X, s):
    """Whether no flight of the box has left the envelope, and whether all is still bounded."""
    for j in range(plan.n_x):
        a, b = bounds(w, X + j, s)
        if not (a > plan.limits[j, 0] and b < plan.limits[j, 1] and w[X + j, 2] < 1e9):
            return False
    if plan.slip >= 0:
        slowest = bounds(w, X + plan.slip, s)[0]
        for j in range(plan.slip + 1, plan.slip + 3):
            a, b = bounds(w, X + j, s)
            if not (slowest > b and slowest > -a):
                return False
    return True


@jit
def flight(plan, low, high, s, threshold, until, metric, back):
    """A lower bound of d_min over the box [low, high] until step `until`: (bound or -1, how many steps were proved)."""
    m = plan.n_x + plan.n_g
    w = np.zeros((plan.rows + m + 4 * plan.n_x + plan.n_y + 3 * plan.n_y + 4, s.width))
    X = plan.rows
    D = X + m + 4 * plan.n_x + plan.n_y
    Y = X + m + plan.n_x
    g = np.zeros((m, s.used - s.frame + m))
    begun(w, plan, low, high, s)
    for j in range(plan.n_x):
        copy(w, X + j, plan.initial.out[j])
    for j in range(plan.n_g):
        constant(w, X + plan.n_x + j, 0.0)
    lowest = math.inf
    for i in range(until + 1):
        stepped(w, plan, i, X, s)
        for c in range(plan.n_y):
            d = D + 3 * c
            copy(w, d + 2, d + 1)
            copy(w, d + 1, d)
            copy(w, d, Y + c)
            rest = w[d, 1]
            for j in range(s.frame, s.used):
                rest += abs(w[d, j])
                w[d, j] = 0.0
            w[d, 1] = rest * UP
            lo = bounds(w, d, s)[0]
            if i >= 2:  # a parabola's vertex lies at most an eighth of the second difference below the lowest sample
                lin3(w, w.shape[0] - 1, 1.0, d, -2.0, d + 1, 1.0, d + 2, 0.0)
                bend = bounds(w, w.shape[0] - 1, s)[1]
                before = bounds(w, d + 1, s)[0] - (bend / 8.0 * UP if bend > 0.0 else 0.0)
                lowest = before if not before > lowest else lowest
            lowest = lo if not lo > lowest else lowest
        if not (lowest > threshold * threshold * UP and inside(w, plan, X, s)):
            return -1.0, i
        if i < until:
            advanced(w, plan, i, X, s)
            reframed(w, X, m, s, g, metric[i], back[i])
    return math.sqrt(lowest) / UP, until


@jit
def linearised(plan, point, s, jacobians, states):
    """The nominal flight's states (steps + 1, m) and the derivative of every step by them (steps, m, m).

    s: a shape with as many parameters as states and guidance.
    """
    m = plan.n_x + plan.n_g
    w = np.zeros((plan.rows + m + 4 * plan.n_x + plan.n_y + 3 * plan.n_y + 4, s.width))
    X = plan.rows
    begun(w, plan, point, point, s)
    for j in range(plan.n_x):
        copy(w, X + j, plan.initial.out[j])
    for i in range(jacobians.shape[0]):
        for j in range(m):
            c = w[X + j, 0]
            states[i, j] = c
            constant(w, X + j, c)
            w[X + j, LINEAR + j] = 1e-9
            w[X + j, 2] += 1e-9
        stepped(w, plan, i, X, s)
        advanced(w, plan, i, X, s)
        for j in range(m):
            for k in range(m):
                jacobians[i, j, k] = w[X + j, LINEAR + k] / 1e-9
