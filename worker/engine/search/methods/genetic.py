"""Genetic algorithm: breeds a population of points over generations, the better ones more often.

Goldberg, Genetic algorithms in search, optimization and machine learning (1989); operators and defaults as published
with MATLAB's ga: population 20, elite 2, crossover fraction 0.8 scattered, roulette selection on fitness 1/sqrt(rank),
Gaussian mutation shrinking to nothing over 100 generations, tolerance 1e-6 over 50 stalled generations. A generation
is one batch; a child equal to a parent keeps its parent's cost. Failed points rank last. It restarts from random points
until the budget ends; the published one stops (`as_published`). No guarantee.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts import breeding


@dataclass(frozen=True)
class Options:
    """The published settings. Starts given in the campaign are the first members of the first population."""

    population: Annotated[int, Field(ge=2, le=10_000, description="Points in a generation")] = 20
    elite: Annotated[int, Field(ge=0, le=10_000, description="Best points that survive unchanged")] = 2
    crossover_fraction: Annotated[
        float, Field(ge=0, le=1, description="Fraction of the other children that come from two parents")
    ] = 0.8
    generations: Annotated[int, Field(ge=1, le=1_000_000, description="Maximum number of generations")] = 100
    stall_generations: Annotated[
        int, Field(ge=1, le=1_000_000, description="Generations over which the best cost must change")
    ] = 50
    stall: Literal["cumulative", "weighted"] = "cumulative"
    tolerance: Annotated[
        float, Field(ge=0, le=1, description="Relative change of the best cost over them that counts as no change")
    ] = 1e-6
    selection: Literal["roulette", "stochastic_uniform", "tournament"] = "roulette"
    entrants: Annotated[int, Field(ge=2, le=1000, description="Points in a tournament")] = 4
    crossover: Literal["scattered", "two_point", "intermediate", "heuristic"] = "scattered"
    ratio: Annotated[float, Field(ge=0, le=2, description="Of intermediate crossover: range towards the other")] = 1.0
    beyond: Annotated[float, Field(ge=1, le=2, description="Of heuristic crossover: 1 ends at the better one")] = 1.2
    mutation: Literal["gaussian", "uniform", "adaptive"] = "gaussian"
    scale: Annotated[
        float, Field(gt=0, le=10, description="Deviation of the first mutations, in fractions of the ranges")
    ] = 1.0
    shrink: Annotated[float, Field(ge=0, le=1, description="Fraction of the deviation lost at the end")] = 1.0
    rate: Annotated[float, Field(ge=0, le=1, description="Of uniform mutation: fraction of parameters redrawn")] = 0.01
    schedules: Annotated[
        int,
        Field(
            ge=0,
            le=1_000_000,
            description="Number of repetitions of the generations, on the same population; 0: from random points, "
            "until the budget ends",
        ),
    ] = 0
    as_published: Annotated[bool, Field(description="Stop after the generations, as published: 0 schedules mean 1")] = (
        False
    )

    @property
    def repetitions(self) -> int:
        """0: until the budget ends."""
        return self.schedules or int(self.as_published)


@dataclass
class Population:
    """Points (m, n) and their costs (m,), infinity if there is no cost; rows never change in place."""

    points: Floats
    costs: Floats

    @property
    def best(self) -> float:
        return float(self.costs.min())


def search(space: Space, options: Options) -> Search:
    """One generation is one request: the children that are not copies of a parent."""
    points = space.random.random((options.population, space.dimension))
    starts = space.starts[: options.population]
    points[: len(starts)] = starts
    batch = yield points.copy()
    population = Population(points, batch.ranked())
    ending = ""
    while options.repetitions == 0:
        yield from _schedule(space, options, population)
        points = space.random.random((options.population, space.dimension))
        batch = yield points.copy()
        population = Population(points, batch.ranked())
    for _ in range(options.repetitions):
        population, ending = yield from _schedule(space, options, population)
    if options.repetitions == 1:
        return ending
    return Ended("iterations", "{schedule}, {times} times", schedule=ending, times=options.repetitions)


def _schedule(
    space: Space, options: Options, population: Population
) -> Generator[Floats, Batch, tuple[Population, str]]:
    """The generations from the first, widest mutations to the last ones."""
    best = [population.best]
    length = options.scale
    for generation in range(1, options.generations + 1):
        if options.mutation == "gaussian":
            length = options.scale * (1.0 - options.shrink * generation / options.generations)
        elif len(best) > 1:
            length = _adapted(length, best[-1] < best[-2], options)
        population = yield from _next(space, options, population, length)
        best.append(population.best)
        if generation > options.stall_generations and _change(best, options) <= options.tolerance:
            return population, Ended(
                "converged", "the best cost no longer changes after {generations} generations", generations=generation
            )
    return population, Ended("iterations", "completed the {generations} generations", generations=options.generations)


def _adapted(length: float, improved: bool, options: Options) -> float:
    """Steps grow fourfold after a generation that improved and shrink fourfold after one that did not."""
    return float(np.clip(length * (4.0 if improved else 0.25), 1e-6, options.scale))


def _change(best: list[float], options: Options) -> float:
    """The relative change of the best cost over the last generations.

    cumulative: the total change. weighted, as in ga: the mean with weights that double from one generation to the next,
    so early changes count little and it mostly stops as soon as allowed.
    """
    last = np.array(best[-options.stall_generations - 1 :])
    if not np.isfinite(last).all():
        return np.inf
    changes = np.abs(np.diff(last)) / (np.abs(last[:-1]) + 1.0)
    if options.stall == "cumulative":
        return float(changes.sum())
    return float((0.5 ** np.arange(len(changes) - 1.0, -1.0, -1.0) * changes).mean())


def _next(
    space: Space, options: Options, population: Population, length: float
) -> Generator[Floats, Batch, Population]:
    """The next generation: the elite, children of two parents, mutated children of one."""
    random, points, costs = space.random, population.points, population.costs
    size = len(points)
    elite = min(options.elite, size - 1)
    crossed = round(options.crossover_fraction * (size - elite))
    mutated = size - elite - crossed
    parents = breeding.SELECT[options.selection](
        random, breeding.expectation(costs), 2 * crossed + mutated, options.entrants
    )
    one, two, alone = parents[:crossed], parents[crossed : 2 * crossed], parents[2 * crossed :]
    swap = costs[two] < costs[one]
    better, worse = np.where(swap, two, one), np.where(swap, one, two)
    children = np.concatenate(
        [
            _crossed(random, options, points[better], points[worse]),
            _mutated(random, options, points[alone], length),
        ]
    )
    np.clip(children, 0.0, 1.0, out=children)
    kin = np.stack([np.concatenate([better, alone]), np.concatenate([worse, alone])])
    same = (points[kin] == children).all(axis=2)
    found = costs[np.where(same[0], kin[0], kin[1])]
    fresh = np.flatnonzero(~same.any(axis=0))
    if len(fresh):
        batch = yield children[fresh]
        found[fresh] = batch.ranked()
    best = np.argsort(costs, kind="stable")[:elite]
    return Population(np.concatenate([points[best], children]), np.concatenate([costs[best], found]))


def _crossed(random: np.random.Generator, options: Options, better: Floats, worse: Floats) -> Floats:
    ratio = options.beyond if options.crossover == "heuristic" else options.ratio
    return breeding.CROSS[options.crossover](random, better, worse, ratio)


def _mutated(random: np.random.Generator, options: Options, parents: Floats, length: float) -> Floats:
    if options.mutation == "gaussian":
        return breeding.gaussian(random, parents, length)
    if options.mutation == "uniform":
        return breeding.uniform(random, parents, options.rate)
    return breeding.directed(random, parents, length)


def extend(options: Options, more: int) -> Options:
    """Repeat the generations on the same population, often enough for the budget, which then ends the search.

    The count assumes the fewest generations of a schedule and a quarter of its mutants; others may be copies. A search
    that restarts continues until the budget ends anyway.
    """
    if options.repetitions == 0:
        return options
    size, elite = options.population, min(options.elite, options.population - 1)
    mutants = size - elite - round(options.crossover_fraction * (size - elite))
    shortest = max(min(options.stall_generations, options.generations) * mutants // 4, 1)
    return replace(options, schedules=min(options.repetitions + -(-more // shortest), 1_000_000))


method = Method(
    name="genetic",
    title="Genetic algorithm",
    kind="global",
    how="Global, random. Breeds a population",
    source="Goldberg 1989, as MATLAB ga 2012",
    evaluations=2000,
    options=Options,
    search=search,
    repeats=True,
    starts=True,
    extend=extend,
    family="population",
    whole_budget=True,
    own_rule="as_published schedules",
    parallel="a generation",
    suits="comparison with published results",
    drawback="Of the targets of BBOB in 5 dimensions it reaches 0.19 at 1,000 n, differential evolution 0.72; of "
    "random landscapes 0.38 and 0.71. On one problem of chasing cars (CC4) it is the best of all",
    proposed=4,
    look=MethodLook(colour="#b97c00", dark="#e69f00", marker="circle", short="GA"),
)
