"""Differential evolution with success-history adaptation (SHADE), until its population has converged.

Tanabe and Fukunaga, Success-history based parameter adaptation for differential evolution (CEC 2013): mutation
current-to-pbest/1 with an archive (Zhang and Sanderson, JADE, IEEE Trans. Evol. Comput. 13, 2009), binomial
recombination, both weights drawn around what succeeded before. Out of the box: half-way from the parent to the face.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.lowest import Lowest

MEMORY = 6
"""Entries of the history; the published 100 suits longer runs."""
STEP, TOLERANCE = 1e-9, 1e-11
"""A population has converged when its points are within this fraction of every range, or its costs within this
fraction of their mean."""
GREEDY = 0.2
"""The largest fraction of the population that counts as its best."""


class History:
    """The means of the weights that succeeded, of the mutation and of the recombination."""

    def __init__(self) -> None:
        self.mutation, self.recombination = np.full(MEMORY, 0.5), np.full(MEMORY, 0.9)
        self.at = 0

    def draw(self, random: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        """The weights of as many mutations and recombinations: Cauchy and normal around an entry."""
        entry = random.integers(MEMORY, size=count)
        weight = self.mutation[entry] + 0.1 * random.standard_cauchy(count)
        while (low := weight <= 0.0).any():
            weight[low] = self.mutation[entry[low]] + 0.1 * random.standard_cauchy(int(low.sum()))
        rate = self.recombination[entry] + 0.1 * random.standard_normal(count)
        return np.minimum(weight, 1.0), np.clip(rate, 0.0, 1.0)

    def learn(self, weight: Floats, rate: Floats, gain: Floats) -> None:
        """Replace the oldest entry by the means of what succeeded, weighted by how much it improved the costs."""
        share = gain / gain.sum()
        self.mutation[self.at] = (share * weight**2).sum() / (share * weight).sum()
        self.recombination[self.at] = (share * rate).sum()
        self.at = (self.at + 1) % MEMORY


def gathered(random: np.random.Generator, points: Floats, best: Lowest) -> Generator[Floats, Batch, int]:
    """Evolve the population from these points until it has converged; returns the generations."""
    size, n = points.shape
    points, history = points.copy(), History()
    costs = (yield points.copy()).ranked()
    best.see(points, costs)
    archive = np.empty((0, n))
    generations = 0
    while not _converged(points, costs):
        generations += 1
        weight, rate = history.draw(random, size)
        trials = _recombined(random, points, _mutants(random, points, costs, archive, weight), rate)
        values = (yield trials.copy()).ranked()
        best.see(trials, values)
        better = values < costs
        if better.any():
            before = costs[better]
            gain = np.where(np.isfinite(before), before, values[better] + 1.0) - values[better]
            history.learn(weight[better], rate[better], gain)
            archive = np.concatenate([archive, points[better]])
            if len(archive) > size:
                archive = archive[random.permutation(len(archive))[:size]]
        accepted = values <= costs
        points[accepted], costs[accepted] = trials[accepted], values[accepted]
    return generations


def _converged(points: Floats, costs: Floats) -> bool:
    """A population of which a part has no value has not converged."""
    if np.ptp(points, axis=0).max() < STEP:
        return True
    return bool(np.isfinite(costs).all() and costs.std() <= TOLERANCE * abs(costs.mean()))


def _mutants(random: np.random.Generator, points: Floats, costs: Floats, archive: Floats, weight: Floats) -> Floats:
    """current-to-pbest/1: each moves towards one of the best and along a difference of two others."""
    size = len(points)
    own = np.arange(size)
    few = np.maximum(np.ceil(random.uniform(2.0 / size, GREEDY, size) * size).astype(np.int64), 1)
    leader = np.argsort(costs, kind="stable")[(random.random(size) * few).astype(np.int64)]
    one = (own + random.integers(1, size, size)) % size
    union = np.concatenate([points, archive])
    other = random.integers(len(union), size=size)
    while (clash := (other == own) | (other == one)).any():
        other[clash] = random.integers(len(union), size=int(clash.sum()))
    step = weight[:, None]
    return np.asarray(points + step * (points[leader] - points) + step * (points[one] - union[other]))


def _recombined(random: np.random.Generator, points: Floats, mutants: Floats, rate: Floats) -> Floats:
    """Recombine points with their mutants; at least one parameter of each comes from its mutant."""
    size, n = points.shape
    taken = random.random((size, n)) < rate[:, None]
    taken[np.arange(size), random.integers(n, size=size)] = True
    mutants = np.where(mutants < 0.0, 0.5 * points, np.where(mutants > 1.0, 0.5 * (1.0 + points), mutants))
    return np.where(taken, mutants, points)
