"""A descent along gradients from one start, by a library; gradients by finite differences as one batch.

Kraft, A software package for sequential quadratic programming (DFVLR-FB 88-28, 1988), as NLopt's LD_SLSQP and SciPy's
SLSQP; Byrd, Lu, Nocedal, Zhu, A limited memory algorithm for bound constrained optimization (SIAM J. Sci. Comput. 16,
1995), as SciPy's L-BFGS-B.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import nlopt
import numpy as np

from worker.engine.search.base import Batch, Ended, Floats
from worker.engine.search.parts.callback import Ask, called_back
from worker.engine.search.parts.one_thread import one_thread

Library = Literal["nlopt", "scipy", "bfgs"]
Objective = Callable[[Floats], tuple[float, Floats]]

LARGE = 1e3
"""If the first slope per range exceeds this, costs are scaled so that it becomes 1."""


class End(NamedTuple):
    """The end of a local search: point (n,), its cost (infinity if none), evaluations used, and the reason."""

    point: Floats
    cost: float
    evaluations: int
    text: str


@dataclass(frozen=True)
class Settings:
    """Differences and tolerances as fractions of each parameter's range and of the cost. most: evaluation limit.

    apart: a slope is requested only where the library asks for one, after its point and not with it: a line search then
    takes one evaluation a step, in smaller requests. Not with L-BFGS-B. gain: a descent ends when two steps together
    lowered the cost by less than this [the cost's unit].
    """

    library: Library = "nlopt"
    differences: Literal["central", "forward"] = "central"
    difference: float = 1e-5
    step_tolerance: float = 1e-7
    cost_tolerance: float = 1e-10
    iterations: int = 200
    most: int = 2**62
    apart: bool = False
    gain: float = 0.0


def descend(start: Floats, settings: Settings) -> Generator[Floats, Batch, End]:
    """Descend from a start; a request has a point and its finite-difference neighbours, so points may repeat."""
    return called_back(lambda ask: _run(ask, start, settings))


class _Stopped(Exception):
    """The descent ends here, with this sentence."""

    def __init__(self, text: Ended) -> None:
        self.text = text


class _Trail:
    """The history of one descent: its lowest point, the distinct points it requested, the unit of its costs."""

    def __init__(self, ask: Ask, start: Floats, settings: Settings) -> None:
        self.ask, self.settings = ask, settings
        self.point = start.copy()
        self.cost = np.inf
        self.seen: set[bytes] = set()
        self.unit = 1.0
        self.at: Floats | None = None
        self.value_there = np.inf
        self.course: list[float] = []
        self.lowest_step = np.inf

    def __call__(self, x: Floats) -> tuple[float, Floats]:
        """Cost and gradient, divided by a number that keeps the first slopes from being large.

        A library's own quadratic programme overflows at slopes of 1e11 per range.
        """
        first = not self.seen
        if self.settings.apart and not first and (value := self.value(x)) >= self.lowest_step:
            return value / self.unit, np.zeros(len(x))  # a line search goes back from here: no slope is used
        points, steps = stencil(_snapped(x), self.settings)
        values = self._values(points)
        self.lowest_step = float(values[0])
        self.step()
        slope = gradient(values, steps)
        if first:
            steepest = float(np.abs(slope).max())
            self.unit = steepest if steepest > LARGE else 1.0
        return float(values[0]) / self.unit, slope / self.unit

    def value(self, x: Floats) -> float:
        """The cost alone, in its own unit."""
        self.at = _snapped(x)
        self.value_there = float(self._values(self.at[None])[0])
        return self.value_there

    def slope(self, x: Floats) -> Floats:
        """The gradient alone; SciPy asks for it where it has just asked for the cost."""
        if self.at is None or not np.array_equal(self.at, _snapped(x)):
            self.value(x)
        points, steps = stencil(_snapped(x), self.settings)
        return gradient(np.concatenate([[self.value_there], self._values(points[1:])]), steps)

    def _values(self, points: Floats) -> Floats:
        if self.seen and len(self.seen) + len(points) > self.settings.most:
            raise _Stopped(Ended("share", "used its {evaluations} evaluations", evaluations=self.settings.most))
        values = self.ask(points).ranked()
        low = int(np.argmin(values))
        if values[low] < self.cost:
            self.cost, self.point = float(values[low]), points[low].copy()
        if not self.seen and not np.isfinite(values[0]):
            raise _Stopped(Ended("no value", "a start could not be evaluated"))
        self.seen.update(p.tobytes() for p in points)
        return values

    def step(self) -> None:
        """A step has ended: the library asks for a slope."""
        self.course.append(self.cost)
        if len(self.course) > 2 and self.course[-3] - self.cost < self.settings.gain:
            raise _Stopped(CHANGES)


def _run(ask: Ask, start: Floats, settings: Settings) -> End:
    trail = _Trail(ask, start, settings)
    run = {"nlopt": _nlopt, "scipy": _scipy, "bfgs": _bfgs}[settings.library]
    try:
        text = run(trail, settings, np.clip(start, 0.0, 1.0))
    except _Stopped as stopped:
        text = stopped.text
    return End(trail.point, trail.cost, len(trail.seen), text)


CHANGES = Ended("converged", "the cost no longer changes")
HOLDS = Ended("optimal", "the optimality conditions hold")
ITERATIONS = Ended("iterations", "used all iterations")
FAILED = Ended("rounding", "the line search failed")


def _nlopt(trail: _Trail, settings: Settings, start: Floats) -> str:
    def objective(x: Floats, slope: Floats) -> float:
        if settings.apart and not slope.size:
            return trail.value(x) / trail.unit
        value, found = trail(x)
        if slope.size:
            slope[:] = found
        return value

    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(start))
    optimiser.set_min_objective(objective)
    optimiser.set_lower_bounds(0.0)
    optimiser.set_upper_bounds(1.0)
    optimiser.set_xtol_abs(settings.step_tolerance)
    optimiser.set_ftol_rel(settings.cost_tolerance)
    optimiser.set_maxeval(settings.iterations)
    try:
        optimiser.optimize(start)
    except (nlopt.RoundoffLimited, nlopt.roundoff_limited):
        return Ended("rounding", "rounding stopped the descent")
    except (nlopt.runtime_error, RuntimeError):  # nlopt.runtime_error is not a subclass of RuntimeError
        return FAILED
    return {
        nlopt.FTOL_REACHED: CHANGES,
        nlopt.XTOL_REACHED: Ended("converged", "the step is within its tolerance"),
        nlopt.MAXEVAL_REACHED: ITERATIONS,
    }.get(optimiser.last_optimize_result(), HOLDS)


def _scipy(trail: _Trail, settings: Settings, start: Floats) -> str:
    from scipy.optimize import minimize  # imported late: slow to load, and not the default

    costs: Any = trail.value if settings.apart else trail
    slopes: Any = trail.slope if settings.apart else True
    with one_thread():
        found = minimize(
            costs, start, method="SLSQP", jac=slopes, bounds=[(0.0, 1.0)] * len(start),
            options={"ftol": settings.cost_tolerance, "maxiter": settings.iterations},
        )  # fmt: skip
    return {0: HOLDS, 8: FAILED, 9: ITERATIONS}.get(found.status, FAILED)


def _bfgs(trail: Objective, settings: Settings, start: Floats) -> str:
    from scipy.optimize import minimize

    with one_thread():
        found = minimize(
            trail, start, method="L-BFGS-B", jac=True, bounds=[(0.0, 1.0)] * len(start),
            options={"ftol": settings.cost_tolerance, "gtol": 0.0, "maxiter": settings.iterations},
        )  # fmt: skip
    return {0: CHANGES, 1: ITERATIONS}.get(found.status, FAILED)


def _snapped(x: Floats) -> Floats:
    """The point with coordinates within rounding of a bound set to it: optimisers return 1 - 3e-16 for 1."""
    x = np.where(x < 1e-12, 0.0, x)
    return np.where(x > 1.0 - 1e-12, 1.0, x)


def stencil(x: Floats, settings: Settings) -> tuple[Floats, Floats]:
    """The point and its neighbours: points (1 + 2 n, n) or (1 + n, n), never outside the box; steps (2 or 1, n)."""
    h = settings.difference
    above = np.minimum(x + h, 1.0) - x
    below = np.maximum(x - h, 0.0) - x
    if settings.differences == "forward":
        steps = np.where(above >= h * 0.5, above, below)[None, :]
    else:
        steps = np.stack([above, below])
    points = [x.copy()]
    for row in steps:
        for i, step in enumerate(row):
            point = x.copy()
            point[i] += step
            points.append(point)
    return np.array(points), steps


def gradient(values: Floats, steps: Floats) -> Floats:
    """Finite differences of the available values; the slope is 0 if neither neighbour has a value."""
    n = steps.shape[1]
    centre = values[0]
    around = values[1:].reshape(len(steps), n)
    usable = np.isfinite(around) & (steps != 0.0)
    if not np.isfinite(centre):
        return np.zeros(n)
    if len(steps) == 1:
        return np.where(usable[0], (around[0] - centre) / np.where(usable[0], steps[0], 1.0), 0.0)
    high = np.where(usable[0], around[0], centre)
    low = np.where(usable[1], around[1], centre)
    width = np.where(usable[0], steps[0], 0.0) - np.where(usable[1], steps[1], 0.0)
    return np.where(width > 0.0, (high - low) / np.where(width > 0.0, width, 1.0), 0.0)
