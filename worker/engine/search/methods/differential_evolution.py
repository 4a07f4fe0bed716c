"""Differential evolution: every member of a population competes with a combination of others and their differences.

Storn and Price, Differential evolution (J. Global Optimization 11, 1997). By default its weights adapt (SHADE, Tanabe
and Fukunaga 2013), and it restarts when the population has converged to one valley, which may be the wrong one. Other
strategies are SciPy's, with its defaults if `as_published`. One generation per batch; a point without a value loses to
every point with one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from worker.engine.search.base import Ended, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.adaptive_de import gathered
from worker.engine.search.parts.callback import Ask, called_back
from worker.engine.search.parts.lowest import Lowest, Reported

GENERATIONS = 10**9
"""Larger than any budget."""
ALWAYS = 1_000_000
"""Restarts until the budget ends; of the published one, the default, which means none."""
SCIPYS_OPTIONS = ("mutation", "dither", "recombination", "tolerance")
SCIPYS, ADAPTIVE, LEAST = 15, 3, 10
"""Members per parameter by default; the least of an adaptive population."""


@dataclass(frozen=True)
class Options:
    """SciPy's names; `mutation` and `dither` are the lower end and width of its pair.

    They, `recombination` and `tolerance` are options of SciPy's strategies: if one of them is stated, the strategy is
    best1bin in place of the adaptive one, which has its own.
    """

    strategy: Literal[
        "adaptive", "best1bin", "best1exp", "best2bin", "best2exp", "rand1bin", "rand1exp", "rand2bin", "rand2exp",
        "randtobest1bin", "randtobest1exp", "currenttobest1bin", "currenttobest1exp",
    ] = "adaptive"  # fmt: skip
    population: Annotated[
        int, Field(ge=0, le=1000, description="Members per parameter; at least 5 in all; 0: 15, of adaptive ones 3")
    ] = 0
    mutation: Annotated[float, Field(ge=0, le=1, description="Weight of a difference, at least")] = 0.5
    dither: Annotated[float, Field(ge=0, le=0.99, description="Random amount added to it each generation")] = 0.5
    recombination: Annotated[float, Field(ge=0, le=1, description="Fraction of parameters from the combination")] = 0.7
    tolerance: Annotated[
        float, Field(ge=0, le=1, description="Stop when the costs' deviation is below this fraction of their mean")
    ] = 0.01
    restarts: Annotated[int, Field(ge=0, le=ALWAYS, description="Number of restarts after such a stop")] = ALWAYS
    as_published: Annotated[
        bool, Field(description="SciPy's: best1bin unless stated, and no restart unless their number is stated")
    ] = False

    @property
    def settled(self) -> Options:
        """The options with SciPy's strategy where its options are stated, and without restarts as published."""
        stated = any(getattr(self, name) != getattr(Options, name) for name in SCIPYS_OPTIONS)
        scipys = self.strategy == "adaptive" and (self.as_published or stated)
        return replace(
            self,
            strategy="best1bin" if scipys else self.strategy,
            restarts=0 if self.as_published and self.restarts == ALWAYS else self.restarts,
        )

    def members(self, dimension: int, run: int) -> int:
        """The size of an adaptive population, larger by half of the first one after every restart."""
        first = max((self.population or ADAPTIVE) * dimension, LEAST)
        return first + run * first // 2


def search(space: Space, options: Options) -> Search:
    """One generation is one request; only the tolerance ends it."""
    options = options.settled
    text = ""
    for run in range(options.restarts + 1):
        text = yield from _gather(space, options, run)
    return (
        text
        if options.restarts == 0
        else Ended(
            "iterations", "completed the {restarts} restarts; finally {last}", restarts=options.restarts, last=text
        )
    )


def _gather(space: Space, options: Options, run: int) -> Search:
    with Reported(space) as best:
        if options.strategy == "adaptive":
            points = space.random.random((options.members(space.dimension, run), space.dimension))
            if run == 0:  # `auto` hands it points
                points[: len(space.starts)] = space.starts
            best.text = _ending((yield from gathered(space.random, points, best)))
        else:
            best.text = yield from called_back(lambda ask: _run(ask, space, options, best))
    return best.text


def _ending(generations: int) -> Ended:
    return Ended(
        "converged", "the population converged to one valley after {generations} generations", generations=generations
    )


def _run(ask: Ask, space: Space, options: Options, best: Lowest) -> str:
    def costs(x: Floats) -> Floats:
        points = np.clip(x.T, 0.0, 1.0)
        values = ask(points.copy()).ranked()
        best.see(points, values)
        return values

    box: Any = [(0.0, 1.0)] * space.dimension
    vectorised: Any = costs
    strategy: Any = options.strategy
    mutation = (options.mutation, options.mutation + options.dither) if options.dither else options.mutation
    from scipy.optimize import differential_evolution  # imported late: slow to load

    done = differential_evolution(
        vectorised,
        box,
        strategy=strategy,
        popsize=options.population or SCIPYS,
        mutation=mutation,
        recombination=options.recombination,
        tol=options.tolerance,
        maxiter=GENERATIONS,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=space.random,
    )
    return _ending(done.nit)


def _unending(options: Options) -> Options:
    """Options whose first populations are the same, and that restart until the budget ends."""
    settled = options.settled
    return options if settled.restarts == ALWAYS else replace(settled, restarts=ALWAYS, as_published=False)


method = Method(
    name="differential_evolution",
    title="Differential evolution",
    kind="global",
    how="Global. A population guided by its differences",
    source="Storn and Price 1997, Tanabe and Fukunaga 2013",
    evaluations=5000,
    options=Options,
    search=search,
    extend=lambda options, more: _unending(options),
    family="population",
    whole_budget=True,
    own_rule="as_published restarts",
    parallel="a generation",
    suits="rough criteria and bent valleys, some thousand evaluations",
    look=MethodLook(colour="#8379ea", dark="#7470e6", marker="down", short="DE"),
)
