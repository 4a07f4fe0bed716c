"""The other integrator: the same components, undecorated, under SciPy's DOP853 with dense output.

Dormand and Prince, order 8(5,3) (Hairer, Norsett, Wanner, Solving ODEs I, 1993, section II.10). It shares neither the
step, the order, the refinement, the compiler nor the elementary functions with the flights of a search. It reads the
criterion that decides and no other. Start reading at `fly`.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from worker.problem import Floats, Problem

NAME = "DOP853"
RELATIVE, ABSOLUTE = 1e-10, 1e-12
COARSE = 1e-4
"""Both tolerances from where the fine ones make no headway: a loop that slides along a switch has no order there."""

STRETCHES = 40
"""A flight without samples of guidance is integrated in so many stretches: only from the one where it stuck on is it
flown at the coarse tolerance."""

STUCK, HEADWAY = 5_000, 1e-3
"""So many calls of the right-hand side for less than this share of the horizon: no headway."""

BEFORE = 1e-8
"""Share of a stretch by which its end is approached where something jumps there."""

APART = 1e-9
"""Instants are apart by more than this [s]."""

LOOKS = 2000
"""Instants at which the channels are read before each minimum is refined."""


@dataclass(frozen=True)
class Flight:
    """The criterion's value, or None with the reason why there is none; `reason` also tells of a coarse tolerance."""

    cost: float | None
    reason: str = ""


def fly(problem: Problem, vector: Floats) -> Flight:
    """Fly one flat parameter vector (size,); the minimum over time comes from the dense output.

    Of several realisations the one that counts, where the worst does: it is that flight which is to be confirmed.
    """
    realised = problem.realisations
    if problem.parts.criterion.over == "crossing":
        return Flight(None, f"{NAME} does not look for crossings, which {problem.parts.criterion.title} reads")
    seeds = realised.seeds
    if realised.several and realised.combine == "worst":
        flown = problem.loop.fly(realised.flights(vector[None, :]), problem.step, *problem.counts(problem.step))
        seeds = (seeds[realised.worst(flown.costs, problem.judge(flown.status, flown.when)[0])],)
    flights = [_realised(problem, realised.flight(vector[None, :], seed)[0]) for seed in seeds]
    for flight, seed in zip(flights, seeds, strict=True):
        if flight.cost is None:
            return Flight(None, f"with seed {seed}: {flight.reason}" if realised.several else flight.reason)
    return Flight(float(np.mean([f.cost for f in flights if f.cost is not None])), flights[0].reason)


def _realised(problem: Problem, vector: Floats) -> Flight:
    try:
        with np.errstate(all="ignore"):
            return _fly(problem, problem.loop.extend(vector))
    except (ArithmeticError, ValueError, _Stuck) as error:
        return Flight(None, f"{NAME} could not fly it: {error}")


class _Stuck(Exception):
    """The integrator makes no headway; the message says when."""


class _Headway:
    """Counts calls of the right-hand side and looks whether time passes."""

    def __init__(self, horizon: float) -> None:
        self.least, self.calls, self.mark = HEADWAY * horizon, 0, 0.0

    def restart(self, t: float) -> None:
        self.calls, self.mark = 0, t

    def watch(self, t: float) -> None:
        self.calls += 1
        if self.calls % STUCK == 0:
            if t - self.mark < self.least:
                raise _Stuck(f"the loop switches to and fro without end from t = {t:.6g} s")
            self.mark = t


def _fly(problem: Problem, p: tuple[float, ...]) -> Flight:
    loop, horizon = problem.loop, problem.campaign.scenario.horizon
    guide, closed_loop, cost = (loop.part(n, library=True) for n in ("guide", "closed_loop", "cost"))
    g = loop.part("blank", library=True)(p)
    x = loop.part("initial", library=True)(p)
    lowest = np.full(loop.channels.total, np.inf)
    deciding = slice(*loop.channels.of["criterion"])
    ticks = _ticks(problem, horizon)
    switches = _switches(problem, p, horizon)
    headway, relative, reason = _Headway(horizon), RELATIVE, ""
    for start, end in pairwise(_joined(ticks, switches)):
        if start in ticks:
            g = guide(start, x, g, p)
        # Without sampling and memory the held guidance is never read. What jumps at the end has not jumped yet.
        last = end - BEFORE * (end - start) if switches else end

        def slope(t: float, y: Floats, g: Any = g, last: float = last) -> Any:
            headway.watch(t)
            return closed_loop(min(t, last), tuple(y.tolist()), g, p)[0]

        try:
            solution = _solved(slope, start, end, x, relative)
        except _Stuck as stuck:
            if relative == COARSE:
                raise
            relative, reason = COARSE, f"at a tolerance of {COARSE:g} from t = {start:.6g} s on: {stuck}"
            headway.restart(start)
            solution = _solved(slope, start, end, x, relative)
        if not solution.success:
            return Flight(None, f"{NAME} stopped at t = {solution.t[-1]:.6g} s: {solution.message}")
        x = tuple(solution.y[:, -1].tolist())
        if not np.isfinite(x).all():
            return Flight(None, f"{NAME}: the state was no longer finite at t = {end:.6g} s")
        looks = max(8, round(LOOKS * (end - start) / horizon))

        def read(t: float, g: Any = g, sol: Any = solution.sol) -> Any:
            return closed_loop(t, tuple(sol(t).tolist()), g, p)[1][deciding]

        lowest[deciding] = np.minimum(lowest[deciding], _lowest(read, np.linspace(start, end, looks + 1)))
    return Flight(float(cost(tuple(lowest.tolist()), p)), reason)


def _solved(slope: Any, start: float, end: float, x: Any, relative: float) -> Any:
    absolute = COARSE if relative == COARSE else ABSOLUTE
    return solve_ivp(  # type: ignore[call-overload]
        slope, (start, end), x, method=NAME, rtol=relative, atol=absolute, dense_output=True
    )


def _switches(problem: Problem, p: tuple[float, ...], horizon: float) -> set[float]:
    """The instants at which a fault or the environment jumps.

    What perception does between the samples of guidance reaches nobody.
    """
    parts, places = problem.parts, problem.loop.extended
    inner = {f"faults.{i}": f.fault for i, f in enumerate(parts.faults) if f.fault.path in ("navigation", "actuator")}
    outer = {f"faults.{i}": f.fault for i, f in enumerate(parts.faults)}
    around = {f"environment.{i}": e for i, e in enumerate(parts.environment)}
    found: set[float] = set()
    for prefix, part in ((inner if parts.sampled else outer) | around).items():
        if part.switches is not None:
            at = places[prefix]
            found.update(part.switches(at.fields(*p[at.first : at.last]), horizon))
    return found


def _joined(ticks: list[float], switches: set[float]) -> list[float]:
    """Both in order; of a tick and a switch at the same instant the tick, of two switches the earlier."""
    joined = list(ticks)
    for t in sorted(switches):
        at = bisect(joined, t)
        if ticks[0] < t < ticks[-1] and min(t - joined[at - 1], joined[at] - t) > APART:
            joined.insert(at, t)
    return joined


def _ticks(problem: Problem, horizon: float) -> list[float]:
    period = problem.campaign.scenario.guidance.period
    if period == 0.0:
        if problem.parts.avoider.memory == 0:
            return [k * horizon / STRETCHES for k in range(STRETCHES)] + [horizon]
        period = problem.step
    return [k * period for k in range(round(horizon / period))] + [horizon]


def _lowest(read: Callable[[float], Any], looks: Floats) -> Floats:
    """The lowest value of every channel over one stretch of dense output."""
    seen = np.array([read(t) for t in looks])
    lowest = seen.min(axis=0)
    for k, i in enumerate(seen.argmin(axis=0)):
        low, high = looks[max(i - 1, 0)], looks[min(i + 1, len(looks) - 1)]
        found = minimize_scalar(
            lambda t, k=k: read(t)[k], bounds=(low, high), method="bounded", options={"xatol": 1e-9}
        )
        lowest[k] = min(lowest[k], found.fun)
    return np.asarray(lowest)
