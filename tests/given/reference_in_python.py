"""The reference integrator in plain Python with SciPy's DOP853, which the compiled one is validated against.

Both share only the components' plain functions, the stretches, the tolerances and the format of the output.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from worker.engine.kernels.bind import plain
from worker.engine.reference.flight import (
    ABSOLUTE,
    COARSE,
    EXCLUDED,
    FARTHEST,
    HEADWAY,
    LARGEST,
    LENIENT,
    NOT_FINITE,
    OK,
    OUTSIDE,
    RELATIVE,
    SHORT,
    STUCK,
)
from worker.engine.reference.instants import Stretches
from worker.engine.reference.reading import READINGS
from worker.engine.reference.reference import Reference
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.assemble import LIBRARY, Loop
from worker.engine.systems.closed_loop.flights import Flights


class PlainReference(Reference):
    """The reference integrator with SciPy's DOP853 in place of the compiled one."""

    def _fly(self, p: tuple[float, ...], stretches: Stretches, found: Floats) -> None:
        fly(self.flights, p, stretches, found)


@cache
def part(loop: Loop, name: str) -> Any:
    """A function of the loop in plain Python with the platform's elementary functions."""
    return plain(loop.kernel(name), LIBRARY)


class _Ended(Exception):
    """A stretch ended before its end: the status and the time [s]."""

    def __init__(self, code: float, when: float) -> None:
        self.code, self.when = code, when


class _Headway:
    """Counts calls of the right-hand side and checks that time progresses."""

    def __init__(self, horizon: float, patience: int) -> None:
        self.least, self.patience, self.calls, self.mark = HEADWAY * horizon, patience, 0, 0.0

    def relax(self, t: float) -> None:
        self.calls, self.mark = 0, t
        self.patience *= LENIENT

    def watch(self, t: float) -> None:
        self.calls += 1
        if self.calls % self.patience == 0:
            if t - self.mark < self.least:
                raise _Ended(STUCK, t)
            self.mark = t


class _Plain:
    """One simulation: its functions and its current state."""

    def __init__(self, flights: Flights, p: tuple[float, ...], stretches: Stretches) -> None:
        self.p, self.stretches = p, stretches
        self.guide, self.closed_loop = part(flights.loop, "guide"), part(flights.loop, "closed_loop")
        self.envelope = part(flights.loop, "envelope")
        self.deciding = slice(*flights.loop.channels.of["criterion"])
        self.horizon = float(stretches.instants[-1])
        self.headway = _Headway(self.horizon, stretches.patience)
        self.g = part(flights.loop, "initial_guidance")(p)
        self.x = part(flights.loop, "initial")(p)
        self.lowest = np.full(flights.loop.channels.total, np.inf)

    def seen(self, t: float, x: Any) -> Any:
        return self.closed_loop(t, tuple(x), self.g, self.p)[1]

    def judge(self, t: float, x: Any) -> None:
        """Raise _Ended if the state or the channels have diverged, or the state is outside the envelope."""
        around = np.abs(self.seen(t, x)[self.deciding]).sum()
        if not (np.abs(x).sum() < LARGEST and around < FARTHEST):
            raise _Ended(NOT_FINITE, t)
        limit = self.envelope(t, tuple(x), self.p)
        if limit > 0.0:
            raise _Ended(OUTSIDE - 1.0 + limit, t)

    def stretch(self, start: float, end: float, tolerances: tuple[float, float]) -> None:
        """Integrate one stretch and update the minima of the channels."""
        from scipy.integrate import solve_ivp  # imported late: a campaign's process must start fast

        last = end - self.stretches.before * (end - start)

        def slope(t: float, y: Floats) -> Any:
            self.headway.watch(t)
            return self.closed_loop(min(t, last), tuple(y.tolist()), self.g, self.p)[0]

        relative, floor = tolerances
        solution: Any = solve_ivp(
            slope, (start, end), self.x, method="DOP853", rtol=relative, atol=floor, dense_output=True
        )
        for t, x in zip(solution.t, solution.y.T, strict=True):
            self.judge(min(float(t), last), x.tolist())
        if not solution.success:
            raise _Ended(SHORT, float(solution.t[-1]))
        samples = max(8, round(READINGS * (end - start) / self.horizon))

        def read(t: float) -> Any:
            return self.seen(min(t, last), solution.sol(t).tolist())[self.deciding]

        found = _lowest(read, np.linspace(start, end, samples + 1))
        self.lowest[self.deciding] = np.minimum(self.lowest[self.deciding], found)
        self.x = tuple(solution.y[:, -1].tolist())


def fly(flights: Flights, p: tuple[float, ...], stretches: Stretches, found: Floats) -> None:
    """Simulate one extended vector of parameters; out: found (6,) as in `flight.fly`."""
    found[1], found[2] = OK, 0.0
    try:
        with np.errstate(all="ignore"):
            simulation = _Plain(flights, p, stretches)
            _fly(flights, simulation, found)
            found[0] = part(flights.loop, "cost")(tuple(simulation.lowest.tolist()), p)
    except _Ended as ended:
        found[1], found[2] = ended.code, ended.when
    except (ArithmeticError, ValueError):
        # Python raises where compiled code continues with infinity or NaN.
        found[1] = NOT_FINITE


def _fly(flights: Flights, simulation: _Plain, found: Floats) -> None:
    tolerances = RELATIVE, ABSOLUTE
    for (start, end), asks in zip(
        pairwise(simulation.stretches.instants.tolist()), simulation.stretches.asks.tolist(), strict=True
    ):
        if asks:
            simulation.g = simulation.guide(start, simulation.x, simulation.g, simulation.p)
        if start == 0.0:
            simulation.judge(start, simulation.x)
            if part(flights.loop, "excluded")(simulation.seen(start, simulation.x), simulation.p):
                raise _Ended(EXCLUDED, start)
        found[2] = start
        try:
            simulation.stretch(start, end, tolerances)
        except _Ended as ended:
            if ended.code > OK or tolerances[0] == COARSE:
                raise
            tolerances = COARSE, COARSE
            found[3], found[4], found[5] = start, ended.code, ended.when
            simulation.headway.relax(start)
            simulation.stretch(start, end, tolerances)
    found[2] = simulation.horizon


def _lowest(read: Callable[[float], Any], times: Floats) -> Floats:
    """The lowest value of every channel over one stretch of dense output, sampled at these times and refined."""
    from scipy.optimize import minimize_scalar

    seen = np.array([read(t) for t in times])
    lowest = seen.min(axis=0)
    for k, i in enumerate(seen.argmin(axis=0)):
        low, high = times[max(i - 1, 0)], times[min(i + 1, len(times) - 1)]
        best = minimize_scalar(lambda t, k=k: read(t)[k], bounds=(low, high), method="bounded", options={"xatol": 1e-9})
        lowest[k] = min(lowest[k], best.fun)
    return np.asarray(lowest)
