"""SQP multistart: sequential quadratic programming from every start in parallel.

Kraft, A software package for sequential quadratic programming (DFVLR-FB 88-28, 1988), as NLopt's LD_SLSQP or, as a
cross-check, SciPy's SLSQP. Gradients by finite differences; a point and its differences are one batch. Finds the
local minimum of each start's valley, with no guarantee about other valleys. Without given starts it takes scrambled
Sobol points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from campaigns.effort import Descents
from worker.engine.search.base import Ended, Floats, Method, MethodLook, Minimum, Parallel, Search, Space, side_by_side
from worker.engine.search.parts.descent import Settings, descend


@dataclass(frozen=True)
class Options:
    """Differences and tolerances are fractions of each parameter's range and of the cost."""

    starts: Annotated[int, Field(ge=1, le=10_000, description="Number of Sobol starts if the campaign gives none")] = 8
    implementation: Literal["nlopt", "scipy"] = "nlopt"
    differences: Literal["central", "forward"] = "central"
    difference: Annotated[float, Field(gt=0, le=0.1, description="Step of the finite differences")] = 1e-5
    step_tolerance: Annotated[float, Field(gt=0, le=0.1, description="Stop when a step is smaller (NLopt's only)")] = (
        1e-7
    )
    cost_tolerance: Annotated[float, Field(ge=0, le=0.1, description="Stop when the cost changes less")] = 1e-10
    iterations: Annotated[int, Field(ge=1, le=100_000, description="Maximum gradients per start")] = 200


def search(space: Space, options: Options) -> Parallel:
    starts = space.starts
    if len(starts) == 0:
        from scipy.stats import qmc  # a campaign's process must start fast

        sampler = qmc.Sobol(space.dimension, rng=space.random)
        starts = sampler.random_base2(int(np.ceil(np.log2(options.starts))))[: options.starts]
    descents = [_descend(space, options, start) for start in starts]
    endings = yield from side_by_side(descents, in_slots=bool(space.slots))
    if len(starts) == 1:
        return endings[0]
    ends = {f"end{i}": end for i, end in enumerate(sorted(set(endings)))}
    if all(isinstance(end, Ended) and end.code == "converged" for end in endings):
        return Ended("members", "all starts converged", **ends)
    return Ended("members", f"all starts ended: {', '.join(f'{{{name}}}' for name in ends)}", **ends)


def _descend(space: Space, options: Options, start: Floats) -> Search:
    settings = Settings(
        library=options.implementation,
        differences=options.differences,
        difference=options.difference,
        step_tolerance=options.step_tolerance,
        cost_tolerance=options.cost_tolerance,
        iterations=options.iterations,
    )
    end = yield from descend(start, settings)
    if np.isfinite(end.cost):
        space.report(Minimum(end.point, end.cost, start, end.evaluations, end.text))
    return end.text


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
    family="gradients",
    effort=Descents("starts", usual=10, least=1, growth=5.5),  # at most 9 with two parameters, 83 with four
    parallel="every descent on its own",
    suits="smooth criteria with known starts",
    earlier=("sqp_multistart",),
    look=MethodLook(colour="#b8578c", dark="#d98db8", marker="triangle", short="SQP"),
)
