"""SQP multistart: sequential quadratic programming from every start, all starts side by side.

Kraft, A software package for sequential quadratic programming (DFVLR-FB 88-28, 1988), as NLopt's LD_SLSQP. Gradients
by finite differences, a point and its differences go out as one batch. Finds the local minimum of each start's valley
and guarantees nothing of the others. Without given starts it takes scrambled Sobol points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import nlopt
import numpy as np
from pydantic import Field
from scipy.stats import qmc

from worker.search.base import Floats, Method, Minimum, Search, Space, side_by_side
from worker.search.callback import Ask, called_back


@dataclass(frozen=True)
class Options:
    """Differences and tolerances are shares of each parameter's range and of the cost."""

    starts: Annotated[int, Field(ge=1, le=10_000, description="Sobol starts where the campaign gives none")] = 8
    differences: Literal["central", "forward"] = "central"
    difference: Annotated[float, Field(gt=0, le=0.1, description="Step of the differences")] = 1e-5
    step_tolerance: Annotated[float, Field(gt=0, le=0.1, description="Stop when a step is smaller")] = 1e-7
    cost_tolerance: Annotated[float, Field(ge=0, le=0.1, description="Stop when the cost changes less")] = 1e-10
    iterations: Annotated[int, Field(ge=1, le=100_000, description="Gradients per start at most")] = 200


def search(space: Space, options: Options) -> Search:
    starts = space.starts
    if len(starts) == 0:
        sampler = qmc.Sobol(space.dimension, rng=space.random)
        starts = sampler.random_base2(int(np.ceil(np.log2(options.starts))))[: options.starts]
    said = yield from side_by_side([_descend(space, options, start) for start in starts])
    return f"every start ended: {', '.join(sorted(set(said)))}" if len(starts) > 1 else said[0]


def _descend(space: Space, options: Options, start: Floats) -> Search:
    return called_back(lambda ask: _run(ask, space, options, start))


class _Trail:
    """What one descent has seen: its lowest point, and how many distinct points it asked for."""

    def __init__(self, start: Floats) -> None:
        self.point = start.copy()
        self.cost = np.inf
        self.seen: set[bytes] = set()

    @property
    def evaluations(self) -> int:
        return len(self.seen)


def _run(ask: Ask, space: Space, options: Options, start: Floats) -> str:
    trail = _Trail(start)

    def objective(x: Floats, gradient: Floats) -> float:
        points, steps = _stencil(_snapped(x), options)
        values = ask(points).ranked()
        first = not trail.seen
        trail.seen.update(p.tobytes() for p in points)
        low = int(np.argmin(values))
        if values[low] < trail.cost:
            trail.cost, trail.point = float(values[low]), points[low].copy()
        if first and not np.isfinite(values[0]):
            raise _NoStart
        if gradient.size:
            gradient[:] = _gradient(values, steps)
        return float(values[0])

    try:
        text = _optimise(objective, options, start)
    except _NoStart:
        text = "a start could not be evaluated"
    if np.isfinite(trail.cost):
        space.report(Minimum(trail.point, trail.cost, start, trail.evaluations, text))
    return text


class _NoStart(Exception):
    pass


def _optimise(objective: Any, options: Options, start: Floats) -> str:
    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(start))
    optimiser.set_min_objective(objective)
    optimiser.set_lower_bounds(0.0)
    optimiser.set_upper_bounds(1.0)
    optimiser.set_xtol_abs(options.step_tolerance)
    optimiser.set_ftol_rel(options.cost_tolerance)
    optimiser.set_maxeval(options.iterations)
    try:
        optimiser.optimize(np.clip(start, 0.0, 1.0))
    except (nlopt.RoundoffLimited, nlopt.roundoff_limited):
        return "rounding stopped the descent"
    except (nlopt.runtime_error, RuntimeError):  # the library's own is no RuntimeError
        return "the line search failed"
    return {
        nlopt.FTOL_REACHED: "the cost no longer changes",
        nlopt.XTOL_REACHED: "the step is within its tolerance",
        nlopt.MAXEVAL_REACHED: "the iterations are used up",
    }.get(optimiser.last_optimize_result(), "the optimality conditions hold")


def _snapped(x: Floats) -> Floats:
    """A point within rounding of a bound, on it: the optimiser leaves 1 - 3e-16 where it means 1."""
    x = np.where(x < 1e-12, 0.0, x)
    return np.where(x > 1.0 - 1e-12, 1.0, x)


def _stencil(x: Floats, options: Options) -> tuple[Floats, Floats]:
    """The point and its neighbours: points (1 + 2 n, n) or (1 + n, n), never outside the box; steps (2 or 1, n)."""
    h = options.difference
    above = np.minimum(x + h, 1.0) - x
    below = np.maximum(x - h, 0.0) - x
    if options.differences == "forward":
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


def _gradient(values: Floats, steps: Floats) -> Floats:
    """Differences from the values that exist; where neither neighbour has one the slope is taken as level."""
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


method = Method(
    name="sqp",
    title="SQP multistart",
    kind="local",
    how="Local gradients from every start",
    source="Kraft 1988, as NLopt LD_SLSQP",
    evaluations=2000,
    options=Options,
    search=search,
    repeats=True,
    starts=True,
)
