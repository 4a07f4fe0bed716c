"""The simulation loop: the classical Runge-Kutta method of order 4 over LANES simulations in lockstep, with slots.

Butcher, Numerical Methods for ODEs (2016), section 322. Every lane does the same arithmetic whatever the others hold,
so the bits of an evaluation never depend on its batch. Start reading at `fly`; `assemble` fills the slots.
"""

from __future__ import annotations

from typing import Any

import numpy as np

N_X = N_P = N_E = N_G = N_Y = N_K = N_Q = N_U = LANES = 0
X = A = B = C = P = G = Y0 = Y1 = Y2 = LOW = K = STATUS = WHEN = SIZE = 0
FROM = RATE = LAST = HELD = SEEN = NEAR = LEFT = RIGHT = AT = PREVIOUS = STOP = STOPPED = 0
TURN = WITHIN = LATEST = 0
SETTLES = SEARCHES = False
REFINED = SEARCHED = STEPS = 0
"""The channels up to the first of these are refined by a parabola, then searched between steps, then read at the steps;
the others are crossings."""
N_S = 0
"""How many obstacles stop. Channels that are refined are searched in the steps about these instants."""
N_T = 0
"""How many legs of obstacles end. Channels are searched on either side of these instants, each for itself."""

BEFORE = 1.0 - 1e-8
"""The last stage is evaluated just before the end of the step, so that a jump at the end belongs to the next step."""

OK = 0.0
NOT_FINITE = 1.0
EXCLUDED = 2.0
OUTSIDE = 3.0
"""Status OUTSIDE + k: limit k of the vehicle's envelope is exceeded, counted from 0."""

LARGEST = 1e12
"""A simulation has diverged when the sum of the absolute values of its states exceeds this."""

FARTHEST = 1e300
"""The same for the channels: they only have to be finite, because squared distances may be large."""


LOOKS, BESIDE = 16, 1e-6
"""Looks at whether a channel rises within a step, each of which halves it; the fraction of the step between two
samples that show it."""


def _slot(*_: Any) -> Any:
    raise NotImplementedError("unfilled slot: call bind.filled first")


load_x = load_p = store_p = load_raw = load_g = load_y = store_x = store_g = store_y = advance = combine = _slot
magnitude_x = magnitude_y = load_q = advance_q = load_u = displaced = _slot
extend = initial = initial_guidance = guide = closed_loop = settled = envelope = costs_of = _slot
excluded = observation = store_k = stops = store_s = turns = store_t = _slot


def fly(params, dt, steps, every, costs, status, when, trace):  # type: ignore[no-untyped-def]
    """Run n simulations.

    params (n, N_P); dt [s]; steps; every: steps per guidance sample (sampled guidance only).
    Out: costs (n, N_K), NaN unless ok; status (n,) as OK, NOT_FINITE, EXCLUDED, OUTSIDE + k; when (n,): end times
    of the simulations [s]; trace (m, steps + 1, N_X + N_G): states and held guidance of the first m simulations.
    """
    n = params.shape[0]
    b = np.empty(SIZE)
    h = 0.5 * dt
    q = dt / 6.0
    last = dt * BEFORE
    for first in range(0, n, LANES):
        for l in range(LANES):
            j = min(first + l, n - 1)
            for k in range(N_P):
                b[P + k * LANES + l] = params[j, k]
        for l in range(LANES):
            store_p(b, P, l, extend(load_raw(b, P, l)))
        for l in range(LANES):
            p = load_p(b, P, l)
            store_g(b, G, l, initial_guidance(p))
            store_x(b, X, l, initial(p))
            b[STATUS + l] = OK
            b[WHEN + l] = 0.0
            if N_S:
                store_s(b, STOP, l, stops(p))
            if N_T:
                store_t(b, TURN, l, turns(p))
        for k in range(N_Y * LANES):
            b[LOW + k] = np.inf
            b[Y1 + k] = np.inf
            b[Y2 + k] = np.inf
        for k in range(REFINED * LANES, SEARCHED * LANES):
            b[Y2 + k] = 0.0
        for k in range(STEPS * LANES, N_Y * LANES):
            b[LOW + k] = steps * dt
            b[Y1 + k] = 1.0
        for i in range(steps + 1):
            t = i * dt
            if i % every == 0:
                for l in range(LANES):
                    store_g(b, G, l, guide(t, load_x(b, X, l), load_g(b, G, l), load_p(b, P, l)))
            since = t - dt if i > 0 else 0.0
            width = dt if i > 0 else 0.0
            for l in range(LANES):
                x = load_x(b, X, l)
                p = load_p(b, P, l)
                dx, y = closed_loop(t, x, load_g(b, G, l), p)
                store_x(b, A, l, dx)
                store_y(b, Y0, l, y)
                code = envelope(t, x, p)
                code = OUTSIDE - 1.0 + code if code > 0.0 else OK
                code = code if (magnitude_x(x) < LARGEST) & (magnitude_y(y) < FARTHEST) else NOT_FINITE
                so_far = b[STATUS + l]
                b[WHEN + l] = t if so_far == OK else b[WHEN + l]
                b[STATUS + l] = code if so_far == OK else so_far
                # The first instant at which a channel is no longer above 0, on the line through two samples. It is
                # inside this loop because LLVM would unroll a short separate loop over the lanes into scalar code.
                for k in range(STEPS, N_Y):
                    at = k * LANES + l
                    mid = b[Y1 + at]
                    right = b[Y0 + at]
                    crossed = since + width * (mid / (mid - right))
                    falls = (mid > 0.0) & (right <= 0.0) & (crossed < b[LOW + at])
                    b[LOW + at] = crossed if falls else b[LOW + at]
                    b[Y1 + at] = right
            if i == 0:
                for l in range(LANES):
                    bar = excluded(load_y(b, Y0, l), load_p(b, P, l))
                    b[STATUS + l] = EXCLUDED if (b[STATUS + l] == OK) & bar else b[STATUS + l]
            # Minimum between steps: the vertex of the parabola through three samples, if it is within half a step of
            # the middle one; also of what lies before it at the start, and after it at the end.
            begins = i == 2
            ends = i == steps
            if N_S:
                for l in range(LANES):
                    about = 0.0
                    for k in range(N_S):
                        stop = b[STOP + k * LANES + l]
                        since_stop = t - stop
                        passed = (stop > 0.0) & (since_stop >= 0.0) & (since_stop < 2.0 * dt)
                        about = 1.0 if passed | ((since_stop < 0.0) & (since_stop >= -dt)) else about
                        for c in range(REFINED):
                            at = c * LANES + l
                            b[Y2 + at] = -np.inf if passed else b[Y2 + at]  # no parabola bends that way
                    b[STOPPED + l] = about
            for k in range(REFINED * LANES):
                left = b[Y2 + k]
                mid = b[Y1 + k]
                right = b[Y0 + k]
                bend = left - 2.0 * mid + right
                slope = left - right
                vertex = mid - 0.125 * slope * slope / bend
                near = ((mid <= left) | begins) & ((mid <= right) | ends) & (abs(slope) <= 2.0 * bend)
                low = vertex if near & (bend > 0.0) else right
                low = low if i >= 2 else right
                b[LOW + k] = low if low < b[LOW + k] else b[LOW + k]
                b[Y2 + k] = mid
                b[Y1 + k] = right
            # Minimum at the steps.
            for k in range(REFINED * LANES, STEPS * LANES):
                right = b[Y0 + k]
                b[LOW + k] = right if right < b[LOW + k] else b[LOW + k]
            if SEARCHES:
                # Minimum between steps of channels with kinks: bisection by whether the channel rises, on the cubic
                # through the states and derivatives at both ends of the step. Only where the channel rises at the end
                # of the step, and changing twice as fast as ever could become lower than it has been; of others, in
                # the steps that a parabola about the instant at which an obstacle stops would have covered.
                # A step in which an obstacle turns or stops is searched up to each of these instants as well, and up to
                # its end from the last one: a channel may fall, rise and fall again.
                pieces = 1
                if N_T:
                    turned = 0.0
                    for l in range(LANES):
                        latest = 0.0
                        for j in range(N_T):
                            at = j * LANES + l
                            s = (b[TURN + at] - since) / dt
                            inside = (s > 2.0 * BESIDE) & (s < 1.0 - 2.0 * BESIDE) & (i > 0)
                            b[WITHIN + at] = s if inside else 0.0
                            latest = b[WITHIN + at] if b[WITHIN + at] > latest else latest
                        b[LATEST + l] = latest
                        turned += latest
                    pieces = 1 + N_T if turned > 0.0 else 1
                for k in range(0 if N_S else REFINED, SEARCHED):
                    for piece in range(pieces):
                        some = 0.0
                        for l in range(LANES):
                            begin = b[LATEST + l] if N_T else 0.0
                            end = 1.0
                            if piece > 0:
                                end = b[WITHIN + (piece - 1) * LANES + l]
                                begin = 0.0
                                for j in range(N_T):
                                    other = b[WITHIN + j * LANES + l]
                                    begin = other if (other < end) & (other > begin) else begin
                                near = end - begin > 2.0 * BESIDE
                            elif k < REFINED:
                                near = b[STOPPED + l] > 0.0
                            else:
                                at = k * LANES + l
                                left = b[Y1 + at]
                                right = b[Y0 + at]
                                change = abs(right - left) if i > 0 else 0.0
                                change = change if change > b[Y2 + at] else b[Y2 + at]
                                least = (left if left < right else right) - 2.0 * change
                                near = (least < b[LOW + at]) | (i == 1) | (begin > 0.0)
                                b[Y2 + at] = change
                                b[Y1 + at] = right
                            b[NEAR + l] = 1.0 if near & (i > 0) & (b[STATUS + l] == OK) else 0.0
                            b[LEFT + l] = begin
                            b[RIGHT + l] = end
                            b[AT + l] = end - BESIDE
                            some += b[NEAR + l]
                        looks = 0
                        while (looks < 2 * LOOKS) & (some > 0.0):
                            beside = looks % 2 == 1
                            for l in range(LANES):
                                s = b[AT + l] + BESIDE if beside else b[AT + l]
                                x = load_x(b, FROM, l)
                                x = advance(x, s * s * (3.0 - 2.0 * s), advance(load_x(b, X, l), -1.0, x))
                                x = advance(x, dt * s * (1.0 - s) * (1.0 - s), load_x(b, RATE, l))
                                x = advance(x, dt * s * s * (s - 1.0), load_x(b, LAST, l))
                                dx, y = closed_loop(since + s * dt, x, load_g(b, HELD, l), load_p(b, P, l))
                                store_y(b, SEEN, l, y)
                            some = 0.0
                            for l in range(LANES):
                                at = k * LANES + l
                                seen = b[SEEN + at]
                                rises = seen > b[PREVIOUS + l]
                                here = b[AT + l]
                                b[PREVIOUS + l] = seen
                                b[LEFT + l] = here if beside & (not rises) else b[LEFT + l]
                                b[RIGHT + l] = here if beside & rises else b[RIGHT + l]
                                b[AT + l] = 0.5 * (b[LEFT + l] + b[RIGHT + l]) if beside else here
                                b[NEAR + l] = 0.0 if (looks == 1) & (not rises) else b[NEAR + l]
                                b[LOW + at] = seen if (b[NEAR + l] > 0.0) & (seen < b[LOW + at]) else b[LOW + at]
                                some += b[NEAR + l]
                            looks += 1
            if trace.shape[0] > first:
                for l in range(min(LANES, trace.shape[0] - first)):
                    for k in range(N_X):
                        trace[first + l, i, k] = b[X + k * LANES + l]
                    for k in range(N_G):
                        trace[first + l, i, N_X + k] = b[G + k * LANES + l]
            if i % 64 == 63:
                running = 0
                for l in range(LANES):
                    running += b[STATUS + l] == OK
                if running == 0:
                    break
            for l in range(LANES):
                x = advance(load_x(b, X, l), h, load_x(b, A, l))
                dx, y = closed_loop(t + h, x, load_g(b, G, l), load_p(b, P, l))
                store_x(b, B, l, dx)
            for l in range(LANES):
                x = advance(load_x(b, X, l), h, load_x(b, B, l))
                dx, y = closed_loop(t + h, x, load_g(b, G, l), load_p(b, P, l))
                store_x(b, C, l, dx)
            for l in range(LANES):
                x = advance(load_x(b, X, l), dt, load_x(b, C, l))
                dx, y = closed_loop(t + last, x, load_g(b, G, l), load_p(b, P, l))
                if SEARCHES:
                    store_x(b, FROM, l, load_x(b, X, l))
                    store_x(b, RATE, l, load_x(b, A, l))
                    store_x(b, LAST, l, dx)
                    store_g(b, HELD, l, load_g(b, G, l))
                store_x(b, X, l, combine(load_x(b, X, l), q, load_x(b, A, l), load_x(b, B, l), load_x(b, C, l), dx))
            if SETTLES:
                for l in range(LANES):
                    store_x(b, X, l, settled(load_x(b, X, l), load_p(b, P, l)))
        for l in range(LANES):
            if first + l < n:
                store_k(b, K, l, costs_of(load_y(b, LOW, l), load_p(b, P, l)))
                for k in range(N_K):
                    costs[first + l, k] = b[K + k * LANES + l] if b[STATUS + l] == OK else np.nan
                status[first + l] = b[STATUS + l]
                when[first + l] = b[WHEN + l]


def observe(states, params, dt, first, seen):  # type: ignore[no-untyped-def]
    """The columns of a trace besides the states: states (rows, N_X + N_G), the first of which is that at step `first`,
    params (N_P,); out: seen (rows, N_W)."""
    b = np.zeros((N_X + N_G + N_E) * LANES)
    for k in range(N_P):
        b[(N_X + N_G + k) * LANES] = params[k]
    p = extend(load_raw(b, (N_X + N_G) * LANES, 0))
    for i in range(states.shape[0]):
        for k in range(N_X + N_G):
            b[k * LANES] = states[i, k]
        values = observation((first + i) * dt, load_x(b, 0, 0), load_g(b, N_X * LANES, 0), p)
        for j, value in enumerate(values):
            seen[i, j] = value


def ahead(start, begin, rate, first, each, seen):  # type: ignore[no-untyped-def]
    """The channels of a vehicle that is moved along a straight line while everything else stays as it is.

    start: state (N_X,), place, velocity along the line, velocity that criteria see (N_Q,), inputs (N_U,), params
    (N_P,); begin: the time at the place [s]; rate: 1, or 0 if time does not pass; first, each: the first instant after
    that, and the interval [s]; out: seen (rows, N_Y).
    """
    b = np.zeros((N_X + 3 * N_Q + N_U + N_E) * LANES)
    for k in range(start.shape[0]):
        b[k * LANES] = start[k]
    x = load_x(b, 0, 0)
    place = load_q(b, N_X * LANES, 0)
    move = load_q(b, (N_X + N_Q) * LANES, 0)
    v = load_q(b, (N_X + 2 * N_Q) * LANES, 0)
    u = load_u(b, (N_X + 3 * N_Q) * LANES, 0)
    p = extend(load_raw(b, (N_X + 3 * N_Q + N_U) * LANES, 0))
    for i in range(seen.shape[0]):
        since = first + i * each
        values = displaced(begin + rate * since, x, advance_q(place, since, move), v, u, p)
        for j, value in enumerate(values):
            seen[i, j] = value
