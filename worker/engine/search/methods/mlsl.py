"""MLSL: a local search from every low sample point without a lower one nearby, in a sample that keeps growing.

Rinnooy Kan and Timmer, Stochastic global optimization methods II: multi level methods (Math. Programming 39, 1987),
with Sobol points (Kucherenko and Sytsko 2005), as NLopt's G_MLSL_LDS. In the limit it finds every local minimum,
each from one start. The library requests one point at a time and does not report where a local search ends, so batch
simulators are used poorly. Only the lowest is reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import nlopt
from pydantic import Field

from worker.engine.search.base import Method, MethodLook, Search, Space
from worker.engine.search.parts.nlopt_calls import optimised

LOCAL = {
    "bobyqa": nlopt.LN_BOBYQA,
    "cobyla": nlopt.LN_COBYLA,
    "nelder_mead": nlopt.LN_NELDERMEAD,
    "subplex": nlopt.LN_SBPLX,
}


@dataclass(frozen=True)
class Options:
    """The local search and the sample."""

    local: Annotated[
        Literal["bobyqa", "cobyla", "nelder_mead", "subplex"], Field(description="The local search, without gradients")
    ] = "bobyqa"
    sample: Annotated[int, Field(ge=0, le=100_000, description="Points per round; 0: NLopt's own 4")] = 0
    tolerance: Annotated[
        float, Field(gt=0, le=0.1, description="A local search ends at this step, as a fraction of each range")
    ] = 1e-5


def search(space: Space, options: Options) -> Search:
    """One point is one request; it runs until the budget ends."""

    def build() -> Any:
        local = nlopt.opt(LOCAL[options.local], space.dimension)
        local.set_xtol_abs(options.tolerance)
        whole = nlopt.opt(nlopt.G_MLSL_LDS, space.dimension)
        whole.set_local_optimizer(local)
        whole.set_population(options.sample)
        return whole

    return (yield from optimised(space, build, random=False))


method = Method(
    name="mlsl",
    title="MLSL",
    kind="global",
    how="Global. Local searches from a growing sample, one point at a time",
    source="Rinnooy Kan and Timmer 1987, as NLopt G_MLSL_LDS",
    evaluations=2000,
    options=Options,
    search=search,
    extend=lambda options, more: options,
    family="multistart",
    whole_budget=True,
    parallel="one point",
    suits="smooth criteria in one slot",
    look=MethodLook(colour="#9a5a44", dark="#c98d78", marker="right"),
)
