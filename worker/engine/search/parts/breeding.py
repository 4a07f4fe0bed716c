"""The operators of a genetic algorithm on a population of points of the unit cube: scaling, selection, crossover,
mutation.

Each operator draws for all children at once. Named as in Chipperfield and Fleming (1995) and Goldberg (1989).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from worker.engine.search.base import Floats

Rows = NDArray[np.intp]


def expectation(costs: Floats) -> Floats:
    """Expected fraction of the parents: proportional to 1 / sqrt(rank), the lowest cost first; sums to 1.

    Only the order counts, so points without a cost (infinity) rank last without a penalty value.
    """
    fractions = np.empty(len(costs))
    fractions[np.argsort(costs, kind="stable")] = 1.0 / np.sqrt(np.arange(1.0, len(costs) + 1.0))
    return np.asarray(fractions / fractions.sum())


def _on_wheel(fractions: Floats, positions: Floats) -> Rows:
    return np.minimum(np.searchsorted(np.cumsum(fractions), positions, side="right"), len(fractions) - 1)


def roulette(random: np.random.Generator, fractions: Floats, count: int, entrants: int) -> Rows:
    """Every parent by a separate spin of a wheel whose slots are as wide as the fractions."""
    return _on_wheel(fractions, random.random(count))


def stochastic_uniform(random: np.random.Generator, fractions: Floats, count: int, entrants: int) -> Rows:
    """Equal steps along the wheel from one random position: a fraction of 10 % gets 10 % of the parents."""
    return random.permutation(_on_wheel(fractions, (random.random() + np.arange(count)) / max(count, 1)))


def tournament(random: np.random.Generator, fractions: Floats, count: int, entrants: int) -> Rows:
    """Every parent is the best of some drawn at random."""
    drawn = random.integers(len(fractions), size=(count, entrants))
    return np.asarray(drawn[np.arange(count), np.argmax(fractions[drawn], axis=1)])


Select = Callable[[np.random.Generator, Floats, int, int], Rows]
SELECT: dict[str, Select] = {select.__name__: select for select in (roulette, stochastic_uniform, tournament)}


def scattered(random: np.random.Generator, better: Floats, worse: Floats, ratio: float) -> Floats:
    """Children with each parameter from one parent or the other, by the toss of a coin."""
    return np.where(random.random(better.shape) < 0.5, better, worse)


def two_point(random: np.random.Generator, better: Floats, worse: Floats, ratio: float) -> Floats:
    """The parameters between two random positions from one parent, the others from the other."""
    m, n = better.shape
    cuts = np.sort(random.integers(n + 1, size=(m, 2)), axis=1)
    at = np.arange(n)
    return np.where((at >= cuts[:, :1]) & (at < cuts[:, 1:]), better, worse)


def intermediate(random: np.random.Generator, better: Floats, worse: Floats, ratio: float) -> Floats:
    """Children between their parents at random in each parameter or, with a ratio above 1, beyond one of them."""
    return better + ratio * random.random(better.shape) * (worse - better)


def heuristic(random: np.random.Generator, better: Floats, worse: Floats, ratio: float) -> Floats:
    """Children on the line from the worse parent to the better one, a little beyond it where the ratio is above 1."""
    return worse + ratio * (better - worse)


Cross = Callable[[np.random.Generator, Floats, Floats, float], Floats]
CROSS: dict[str, Cross] = {cross.__name__: cross for cross in (scattered, two_point, intermediate, heuristic)}


def gaussian(random: np.random.Generator, parents: Floats, deviation: float) -> Floats:
    """Every parameter of every parent moved by a normal step of this deviation, in fractions of its range."""
    return parents + deviation * random.standard_normal(parents.shape)


def uniform(random: np.random.Generator, parents: Floats, rate: float) -> Floats:
    """Every parameter redrawn from its range with this probability."""
    mutated = random.random(parents.shape) < rate
    return np.where(mutated, random.random(parents.shape), parents)


def directed(random: np.random.Generator, parents: Floats, length: float) -> Floats:
    """Every parent moved by this length, in fractions of the ranges, along a random direction."""
    direction = random.standard_normal(parents.shape)
    return np.asarray(parents + length * direction / np.linalg.norm(direction, axis=1, keepdims=True))
