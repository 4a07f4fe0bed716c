"""Differential evolution: every member of a population competes with a combination of others and their differences.

Storn and Price, Differential evolution (J. Global Optimization 11, 1997), as SciPy's differential_evolution with its
defaults, one generation per batch. A point without a value loses to every point with one. It ends when the population
has converged to one valley, which may be the wrong one; restarts help.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from worker.engine.search.base import Ended, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.callback import Ask, called_back
from worker.engine.search.parts.lowest import Lowest, Reported

GENERATIONS = 10**9
"""Larger than any budget."""


@dataclass(frozen=True)
class Options:
    """SciPy's names and defaults, except that `mutation` and `dither` are the lower end and width of its pair."""

    strategy: Literal[
        "best1bin", "best1exp", "best2bin", "best2exp", "rand1bin", "rand1exp", "rand2bin", "rand2exp",
        "randtobest1bin", "randtobest1exp", "currenttobest1bin", "currenttobest1exp",
    ] = "best1bin"  # fmt: skip
    population: Annotated[int, Field(ge=1, le=1000, description="Members per parameter; at least 5 in all")] = 15
    mutation: Annotated[float, Field(ge=0, le=1, description="Weight of a difference, at least")] = 0.5
    dither: Annotated[float, Field(ge=0, le=0.99, description="Random amount added to it each generation")] = 0.5
    recombination: Annotated[float, Field(ge=0, le=1, description="Fraction of parameters from the combination")] = 0.7
    tolerance: Annotated[
        float, Field(ge=0, le=1, description="Stop when the costs' deviation is below this fraction of their mean")
    ] = 0.01
    restarts: Annotated[int, Field(ge=0, le=1_000_000, description="Number of restarts after such a stop")] = 0


def search(space: Space, options: Options) -> Search:
    """One generation is one request; only the tolerance ends it."""
    text = ""
    for _ in range(options.restarts + 1):
        text = yield from _gather(space, options)
    return (
        text
        if options.restarts == 0
        else Ended(
            "iterations", "completed the {restarts} restarts; finally {last}", restarts=options.restarts, last=text
        )
    )


def _gather(space: Space, options: Options) -> Search:
    with Reported(space) as best:
        best.text = yield from called_back(lambda ask: _run(ask, space, options, best))
    return best.text


def _run(ask: Ask, space: Space, options: Options, best: Lowest) -> str:
    def costs(x: Floats) -> Floats:
        points = np.clip(x.T, 0.0, 1.0)
        values = ask(points.copy()).ranked()
        best.see(points, values)
        return values

    box: Any = [(0.0, 1.0)] * space.dimension
    vectorised: Any = costs
    mutation = (options.mutation, options.mutation + options.dither) if options.dither else options.mutation
    from scipy.optimize import differential_evolution  # imported late: slow to load

    done = differential_evolution(
        vectorised,
        box,
        strategy=options.strategy,
        popsize=options.population,
        mutation=mutation,
        recombination=options.recombination,
        tol=options.tolerance,
        maxiter=GENERATIONS,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=space.random,
    )
    return Ended(
        "converged", "the population converged to one valley after {generations} generations", generations=done.nit
    )


method = Method(
    name="differential_evolution",
    title="Differential evolution",
    kind="global",
    how="Global. A population guided by its differences",
    source="Storn and Price 1997, as SciPy",
    evaluations=5000,
    options=Options,
    search=search,
    extend=lambda options, more: replace(options, restarts=1_000_000),
    family="population",
    parallel="a generation",
    suits="rough criteria with many evaluations",
    look=MethodLook(colour="#8379ea", dark="#7470e6", marker="down", short="DE"),
)
