"""NSGA-II: breeds a population towards the Pareto front of several criteria, where none can improve alone.

Deb, Pratap, Agarwal and Meyarivan, A fast and elitist multiobjective genetic algorithm: NSGA-II (IEEE Transactions on
Evolutionary Computation 6, 2002), point by point as pymoo: tournaments by front and crowding distance, simulated binary
crossover, polynomial mutation; population 100, 250 generations, crossover 0.9, mutation 1/n, both indices 20. A
generation is one batch; children equal to a point of the population are bred again. Failed and excluded points rank
behind all others, by the paper's rule for constraints, and get no value. With one criterion it is a genetic algorithm.
No guarantee: its front is the best found so far.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from campaigns.results.base import OK
from worker.engine.search.base import Ended, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.fronts import Population, survivors, tournaments

EQUAL = 1e-16
"""Two points are one if they are not farther apart than this."""
TOO_CLOSE = 1e-14
"""Parents whose values of a parameter differ by no more are not crossed in it."""
ATTEMPTS = 100
"""To breed points that do not exist yet."""


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
    points = points[np.sort(np.unique(points, axis=0, return_index=True)[1])]  # as pymoo, without duplicates
    batch = yield points.copy()
    random = np.random.default_rng(int(space.random.integers(2**31)))
    population = survivors(random, points, batch.costs, batch.status == OK, len(points))
    for generation in range(1, options.generations):
        children = _children(random, population, options)
        if len(children) == 0:
            return Ended("exhausted", "bred no new point after {generations} generations", generations=generation)
        batch = yield children.copy()
        population = survivors(
            random,
            np.concatenate([population.points, children]),
            np.concatenate([population.costs, batch.costs]),
            np.concatenate([population.valued, batch.status == OK]),
            options.population,
        )
    return Ended("iterations", "completed the {generations} generations", generations=options.generations)


def _children(random: np.random.Generator, population: Population, options: Options) -> Floats:
    """New points, as many as the population has; fewer if most attempts equal points that exist."""
    from scipy.spatial.distance import cdist  # imported late: slow to load

    children = np.empty((0, population.points.shape[1]))
    for _ in range(ATTEMPTS):
        missing = options.population - len(children)
        parents = tournaments(random, population, 2 * -(-missing // 2)).reshape(-1, 2)
        bred = _mutated(random, _crossed(random, population.points[parents.T], options), options)
        bred = bred[~np.tril(cdist(bred, bred) <= EQUAL, -1).any(axis=1)]
        for known in (population.points, children):
            bred = bred[~(cdist(bred, known) <= EQUAL).any(axis=1)]
        children = np.concatenate([children, bred[:missing]])
        if len(children) == options.population:
            break
    return children


def _crossed(random: np.random.Generator, parents: Floats, options: Options) -> Floats:
    """Simulated binary crossover of pairs (2, m, n) of parents, each parameter of a pair with probability one half.

    Deb and Agrawal, Simulated binary crossover for continuous search space (Complex Systems 9, 1995), within bounds.
    """
    pairs, n = parents.shape[1:]
    crossed = np.less(random.random(pairs), options.crossover)
    if not crossed.any():
        return parents.reshape(-1, n)
    random.random(pairs)  # pymoo's draw whether a pair exchanges parameters: always
    chosen = (random.random((pairs, n)) < 0.5) & ~(np.abs(parents[0] - parents[1]) <= TOO_CLOSE)
    one, other = parents[0][chosen], parents[1][chosen]
    low, high = np.minimum(one, other), np.maximum(one, other)
    drawn, distance = random.random(len(one)), high - low
    power = np.full(len(one), options.crossover_index + 1.0)

    def spread(room: Floats) -> Floats:
        """beta_q of the paper, where the nearer face is this far from the parents."""
        alpha = 2.0 - np.power(1.0 + 2.0 * room / distance, -power)
        inner = drawn <= 1.0 / alpha
        return np.asarray(np.power(np.where(inner, drawn * alpha, 1.0 / (2.0 - drawn * alpha)), 1.0 / power))

    below = 0.5 * ((low + high) - spread(low) * distance)
    above = 0.5 * ((low + high) + spread(1.0 - high) * distance)
    swapped = random.random(len(one)) < 0.5
    children = parents.copy()
    children[0][chosen], children[1][chosen] = np.where(swapped, (above, below), (below, above))
    children[:, ~crossed] = parents[:, ~crossed]
    return np.clip(children, 0.0, 1.0).reshape(-1, n)


def _mutated(random: np.random.Generator, points: Floats, options: Options) -> Floats:
    """Polynomial mutation of a part of the parameters of points (m, n).

    Deb and Goyal, A combined genetic adaptive search for engineering design (Computer Science and Informatics, 1996).
    """
    chosen = random.random(points.shape) < (options.mutation or 1.0 / points.shape[1])
    x = points[chosen]
    power = np.full(len(x), options.mutation_index + 1.0)
    drawn = random.random(len(x))
    with np.errstate(invalid="ignore"):
        down = np.power(2.0 * drawn + (1.0 - 2.0 * drawn) * np.power(1.0 - x, power), 1.0 / power) - 1.0
        to_face = 1.0 - (1.0 - x)
        up = 1.0 - np.power(2.0 * (1.0 - drawn) + 2.0 * (drawn - 0.5) * np.power(to_face, power), 1.0 / power)
    mutated = points.copy()
    mutated[chosen] = x + np.where(drawn <= 0.5, down, up)
    random.random(len(points))  # pymoo's draw whether a point is mutated: always
    return np.clip(mutated, 0.0, 1.0)


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
    compiles=True,
    extend=extend,
    family="population",
    whole_budget=True,
    own_rule="generations population",
    parallel="a generation",
    suits="the trade-off between criteria",
    look=MethodLook(colour="#9c1257", dark="#e8589b", marker="bow"),
)
