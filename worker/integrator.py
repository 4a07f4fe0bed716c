"""The other integrator: the same components, undecorated, under SciPy's DOP853 with dense output.

Dormand and Prince, order 8(5,3) (Hairer, Norsett, Wanner, Solving ODEs I, 1993, section II.10). It shares neither the
step, the order, the refinement nor the compiler with the flights of a search. Start reading at `fly`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from worker.problem import Floats, Problem

NAME = "DOP853"
RELATIVE, ABSOLUTE = 1e-10, 1e-12
LOOKS = 4000
"""Instants at which the channels are read before each minimum is refined."""


@dataclass(frozen=True)
class Flight:
    """The criterion's value, or None with the reason why there is none."""

    cost: float | None
    reason: str = ""


def fly(problem: Problem, vector: Floats) -> Flight:
    """Fly one flat parameter vector (size,); the minimum over time comes from the dense output."""
    try:
        with np.errstate(all="ignore"):
            return _fly(problem, problem.loop.extend(vector))
    except (ArithmeticError, ValueError) as error:
        return Flight(None, f"{NAME} could not fly it: {error}")


def _fly(problem: Problem, p: tuple[float, ...]) -> Flight:
    loop, horizon = problem.loop, problem.campaign.scenario.horizon
    guide, closed_loop, cost = (loop.part(n) for n in ("guide", "closed_loop", "cost"))
    g = loop.part("blank")(p)
    x = loop.part("initial")(p)
    lowest = np.full(loop.n_channels, np.inf)
    ticks = _ticks(problem, horizon)
    for start, end in pairwise(ticks):
        g = guide(start, x, g, p)
        # Without sampling and memory the held guidance is never read, and there is one stretch only.
        solution: Any = solve_ivp(  # type: ignore[call-overload]
            lambda t, y, g=g: closed_loop(t, tuple(y.tolist()), g, p)[0],
            (start, end), x, method=NAME, rtol=RELATIVE, atol=ABSOLUTE, dense_output=True,
        )  # fmt: skip
        if not solution.success:
            return Flight(None, f"{NAME} stopped at t = {solution.t[-1]:.6g} s: {solution.message}")
        x = tuple(solution.y[:, -1].tolist())
        if not np.isfinite(x).all():
            return Flight(None, f"{NAME}: the state was no longer finite at t = {end:.6g} s")
        looks = max(8, round(LOOKS * (end - start) / horizon))
        lowest = np.minimum(lowest, _lowest(solution.sol, closed_loop, g, p, np.linspace(start, end, looks + 1)))
    return Flight(float(cost(tuple(lowest.tolist()), p)))


def _ticks(problem: Problem, horizon: float) -> list[float]:
    period = problem.campaign.scenario.guidance.period
    if period == 0.0:
        if problem.parts.avoider.memory == 0:
            return [0.0, horizon]
        period = problem.step
    return [k * period for k in range(round(horizon / period))] + [horizon]


def _lowest(sol: Any, closed_loop: Any, g: Any, p: Any, looks: Floats) -> Floats:
    """The lowest value of every channel over one stretch of dense output."""

    def read(t: float) -> tuple[float, ...]:
        return closed_loop(t, tuple(sol(t).tolist()), g, p)[1]  # type: ignore[no-any-return]

    seen = np.array([read(t) for t in looks])
    lowest = seen.min(axis=0)
    for k, i in enumerate(seen.argmin(axis=0)):
        low, high = looks[max(i - 1, 0)], looks[min(i + 1, len(looks) - 1)]
        found = minimize_scalar(
            lambda t, k=k: read(t)[k], bounds=(low, high), method="bounded", options={"xatol": 1e-9}
        )
        lowest[k] = min(lowest[k], found.fun)
    return np.asarray(lowest)
