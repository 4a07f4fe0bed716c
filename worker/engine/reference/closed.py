"""A closed loop as a system for the reference integrator: a template with slots, which `compiled` fills."""

from __future__ import annotations

from typing import Any

from numba import carray  # type: ignore[attr-defined]

from worker.engine.reference.stepper import BARRED, BEGIN, DRAW, LIMIT, SAMPLE, SEE, SLOPE

N_X = N_P = N_D = N_G = N_Y = Y0 = Y1 = D0 = D1 = 0
AHEAD: Any = ()
"""Zeros for the channels of other criteria that precede the deciding one."""


def _slot(*_: Any) -> Any:
    raise NotImplementedError("unfilled slot: call bind.filled first")


load_x = store_x = load_g = store_g = load_p = store_d = load_y = store_y = _slot
initial = initial_guidance = guide = closed_loop = envelope = cost = excluded = drawn = before = one = _slot


def answer(what: int, t: float, x: Any, dx: Any, y: Any, p: Any) -> float:
    """Answers `stepper.call`; p: the extended parameters (N_P,), followed by the stored noise (N_D,) and the held
    guidance (N_G,)."""
    xs, dxs, ys, ps = carray(x, N_X), carray(dx, N_X), carray(y, N_Y), carray(p, N_P + N_D + N_G)
    extended = load_p(ps, 0, 0)
    if what == SLOPE:
        rate, channels = closed_loop(t, load_x(xs, 0, 0), load_g(ps, N_P + N_D, 0), extended)
        store_x(dxs, 0, 0, rate)
        store_y(ys, 0, 0, channels[Y0:Y1])
    elif what == SEE:  # the compiler drops what only the slope needs
        store_y(ys, 0, 0, closed_loop(t, load_x(xs, 0, 0), load_g(ps, N_P + N_D, 0), extended)[1][Y0:Y1])
    elif what == SAMPLE:
        store_g(ps, N_P + N_D, 0, guide(t, load_x(xs, 0, 0), load_g(ps, N_P + N_D, 0), extended))
    elif what == DRAW:
        store_d(ps, N_P, 0, drawn(t, extended))
    elif what == BEGIN:
        store_g(ps, N_P + N_D, 0, initial_guidance(extended))
        store_x(xs, 0, 0, initial(extended))
    elif what == LIMIT:
        return envelope(t, load_x(xs, 0, 0), extended)  # type: ignore[no-any-return]
    elif what == BARRED:
        return 1.0 if excluded(AHEAD + load_y(ys, 0, 0), extended) else 0.0
    else:
        return cost(AHEAD + load_y(ys, 0, 0), extended)  # type: ignore[no-any-return]
    return 0.0


def none_drawn(t: float, p: Any) -> tuple[()]:
    """The draws of noise of a loop none of whose components draws any."""
    return ()


def more_drawn(t: float, p: Any) -> Any:
    """The noise drawn before, and that of one more component."""
    return before(t, p) + one(t, p)


def stored(t: float, p: Any) -> Any:
    """The noise drawn at the start of the stretch, in place of drawing it again."""
    return p[D0:D1]
