"""NSGA-II: breeds a population towards the Pareto front of several criteria, where none can improve alone.

Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm: NSGA-II (IEEE Transactions on
Evolutionary Computation 6, 2002), as pymoo: tournaments by front and crowding distance, simulated binary crossover,
polynomial mutation; population 100, 250 generations, crossover 0.9, mutation 1/n, both indices 20. A generation is one
batch; children equal to a point of the population are bred again. Failed and excluded points rank behind all others,
by the paper's rule for constraints, and get no value. With one criterion it is a genetic algorithm. No guarantee: its
front is the best found so far.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from campaigns.results.base import OK
from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Search, Space


@dataclass(frozen=True)
class Options:
    """The published settings. Starts given in the campaign are the first members of the first population."""

    population: Annotated[int, Field(ge=2, le=10_000, description="Points in a generation")] = 100
    generations: Annotated[int, Field(ge=1, le=10_000_000, description="Maximum number of generations")] = 250
    crossover: Annotated[float, Field(ge=0, le=1, description="Fraction of the pairs that are crossed")] = 0.9
    crossover_index: Annotated[
        float, Field(ge=0, le=1000, description="The larger, the nearer children are to their parents")
    ] = 20.0
    mutation: Annotated[float | None, Field(gt=0, le=1, description="Fraction of parameters mutated; null: 1/n")] = None
    mutation_index: Annotated[float, Field(ge=0, le=1000, description="The larger, the smaller mutations are")] = 20.0


def search(space: Space, options: Options) -> Search:
    """One generation is one request; the first batch determines the number of criteria."""
    points = space.random.random((options.population, space.dimension))
    starts = space.starts[: options.population]
    points[: len(starts)] = starts
    points = points[np.sort(np.unique(points, axis=0, return_index=True)[1])]  # the library drops duplicates
    batch = yield points.copy()
    breeder = _breeder(space, options, points, batch.costs.shape[1])
    breeder.tell(infills=_evaluated(breeder, breeder.ask(), batch))
    for generation in range(1, options.generations):
        children = breeder.ask()
        if children is None or len(children) == 0:
            return Ended("exhausted", "bred no new point after {generations} generations", generations=generation)
        batch = yield np.clip(children.get("X").astype(np.float64), 0.0, 1.0)
        breeder.tell(infills=_evaluated(breeder, children, batch))
    return Ended("iterations", "completed the {generations} generations", generations=options.generations)


def _breeder(space: Space, options: Options, points: Floats, criteria: int) -> Any:
    """The library's algorithm, starting with these points; imported late because it is slow to load."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.population import Population
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.operators.crossover.sbx import SBX
    from pymoo.operators.mutation.pm import PM

    breeder = NSGA2(
        pop_size=options.population,
        sampling=Population.new("X", points.copy()),
        crossover=SBX(prob=options.crossover, eta=options.crossover_index),
        mutation=PM(prob=1.0, prob_var=options.mutation or 1.0 / space.dimension, eta=options.mutation_index),
    )
    breeder.tournament_type = "comp_by_rank_and_crowding"
    problem = Problem(n_var=space.dimension, n_obj=criteria, n_ieq_constr=1, xl=0.0, xu=1.0)
    breeder.setup(problem, termination=NoTermination(), seed=int(space.random.integers(2**31)))
    return breeder


def _evaluated(breeder: Any, population: Any, batch: Batch) -> Any:
    """The points with their costs; a point without a cost violates a constraint, so its costs are never used."""
    from pymoo.problems.static import StaticProblem

    lost = batch.status != OK
    costs = np.where(lost[:, None], 0.0, batch.costs)
    breeder.evaluator.eval(StaticProblem(breeder.problem, F=costs, G=np.where(lost, 1.0, -1.0)[:, None]), population)
    return population


def extend(options: Options, more: int) -> Options:
    """Enough further generations, at one new point or more per generation; the budget ends the search."""
    return replace(options, generations=min(options.generations + more, 10_000_000))


method = Method(
    name="nsga2",
    title="NSGA-II",
    kind="multi",
    how="Several criteria, random. Breeds their Pareto front",
    source="Deb et al. 2002",
    evaluations=5000,
    options=Options,
    search=search,
    starts=True,
    extend=extend,
    family="population",
    whole_budget=True,
    parallel="a generation",
    suits="the trade-off between criteria",
    look=MethodLook(colour="#9c1257", dark="#e8589b", marker="bow"),
)
