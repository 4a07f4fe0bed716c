"""TuRBO: Bayesian optimisation in a trust region, for evaluations so expensive that there are only tens or hundreds.

Eriksson et al., Scalable global optimization via local Bayesian optimization (NeurIPS 2019), with one trust region and
a Gaussian process of our own. It begins with a Latin hypercube of 2 n points. Then each request consists of Thompson
samples: functions drawn from the process, each minimised over candidates in a box around the best point. The box grows
after successes, shrinks after failures to improve, and a new search begins when it is small. Failed evaluations have
no value; a second process is fitted to their labels (-1 succeeded, 1 failed), and a candidate is chosen only if its
label, drawn from that process, is negative, as constraints are treated by Eriksson and Poloczek (SCBO, AISTATS 2021).
It takes up to tens of milliseconds of its own for each evaluation. Global by its restarts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from worker.engine.search.base import Batch, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.gaussian_process import Process, fitted
from worker.engine.search.parts.lowest import Lowest, Reported

# The published settings, section 2 and the authors' program.
FIRST, SHORTEST, LONGEST = 0.8, 0.5**7, 1.6
"""Length of the box: at first, when a new search begins, at most."""
SUCCESSES = 3
"""Successes in a row until the box doubles."""
BETTER = 1e-3
"""An improvement by this fraction of the best cost is a success."""
MOVED = 20
"""Parameters of a candidate that differ from the centre, on average."""
CANDIDATES = (100, 5000)
"""Candidates per parameter, and at most."""
MOST = 256
"""Points in a process at most, those nearest to the centre: a fit takes time with the cube of their number."""


@dataclass(frozen=True)
class Options:
    """The number of points of a request should be that of the evaluations that run side by side."""

    batch: Annotated[int, Field(ge=1, le=100, description="Points per request")] = 4
    initial: Annotated[int, Field(ge=1, le=100, description="Points per parameter before the first model")] = 2


def search(space: Space, options: Options) -> Search:
    """One request is a batch of Thompson samples; it restarts until the budget ends."""
    tested = Evaluated(np.empty((0, space.dimension)), np.empty(0))
    while True:
        with Reported(space) as best:
            first = len(tested.points)
            while tested.valued(first) < 2:  # without two values there is nothing to model
                points = hypercube(options.initial * space.dimension, space)
                tested = tested.add(points, (yield points.copy()), best)
            region = Region(space.dimension, options.batch)
            models: tuple[Process | None, Process | None] = None, None
            while region.length >= SHORTEST:
                assert best.point is not None
                points, models = _chosen(space, options, tested, first, best.point, region, models)
                before = best.cost
                tested = tested.add(points, (yield points.copy()), best)
                region.update(before, best.cost)
            best.text = "the trust region became small"


@dataclass(frozen=True)
class Evaluated:
    """Evaluated points (m, n) and their costs (m,), infinite where there is none."""

    points: Floats
    costs: Floats

    def add(self, points: Floats, batch: Batch, best: Lowest) -> Evaluated:
        """The evaluations with a further batch, which also updates the best point."""
        costs = batch.ranked()
        best.see(points, costs)
        return Evaluated(np.concatenate([self.points, points]), np.concatenate([self.costs, costs]))

    def valued(self, first: int) -> int:
        """The number of points from an index on that have a value."""
        return int(np.isfinite(self.costs[first:]).sum())


class Region:
    """The length of the trust region, which follows from successes and failures in a row."""

    def __init__(self, dimension: int, batch: int) -> None:
        self.length, self.successes, self.failures = FIRST, 0, 0
        self.patience = math.ceil(max(4 / batch, dimension / batch))

    def update(self, before: float, after: float) -> None:
        """A batch that lowered the best cost enough is a success, any other a failure."""
        if after < before - BETTER * abs(before):
            self.successes, self.failures = self.successes + 1, 0
        else:
            self.successes, self.failures = 0, self.failures + 1
        if self.successes == SUCCESSES:
            self.length, self.successes = min(2.0 * self.length, LONGEST), 0
        elif self.failures == self.patience:
            self.length, self.failures = self.length / 2.0, 0

    def box(self, centre: Floats, lengths: Floats) -> tuple[Floats, Floats]:
        """Lower and upper corner: sides in proportion to the length scales, with the volume of a cube."""
        sides = self.length * lengths / np.exp(np.log(lengths).mean())
        return np.clip(centre - sides / 2.0, 0.0, 1.0), np.clip(centre + sides / 2.0, 0.0, 1.0)


Models = tuple[Process | None, Process | None]


def _chosen(
    space: Space, options: Options, tested: Evaluated, first: int, centre: Floats, region: Region, before: Models
) -> tuple[Floats, Models]:
    """The next batch of points, and the processes of costs and of labels that chose it."""
    own = Evaluated(tested.points[first:], tested.costs[first:])
    known = np.isfinite(own.costs)
    near = _nearest(own.points[known], centre)
    cost = fitted(own.points[known][near], _moderate(own.costs[known][near]), before[0])
    label = None
    if not np.isfinite(tested.costs).all():  # where evaluations fail stays known after a restart
        near = _nearest(tested.points, centre)
        label = fitted(tested.points[near], np.where(np.isfinite(tested.costs[near]), -1.0, 1.0), before[1])
    points = candidates(space, centre, *region.box(centre, cost.lengths))
    samples = cost.sampled(points, options.batch, space.random)
    labels = None if label is None else label.sampled(points, options.batch, space.random)
    return points[lowest_of(samples, labels)], (cost, label)


def lowest_of(samples: Floats, labels: Floats | None) -> NDArray[np.intp]:
    """The candidate of each sample (q, p) with the lowest cost among those that succeed by the labels drawn with it.

    Where none succeeds, the one with the lowest label. No candidate is chosen twice.
    """
    count = min(len(samples), samples.shape[1])
    chosen = np.empty(count, dtype=np.intp)
    free = np.ones(samples.shape[1], dtype=bool)
    for k in range(count):
        rank = samples[k]
        if labels is not None:
            succeeds = labels[k] < 0.0
            rank = np.where(succeeds, rank, np.inf) if (succeeds & free).any() else labels[k]
        chosen[k] = int(np.argmin(np.where(free, rank, np.inf)))
        free[chosen[k]] = False
    return chosen


def candidates(space: Space, centre: Floats, low: Floats, high: Floats) -> Floats:
    """Points (p, n) of the box that differ from its centre in some parameters only, at least in one."""
    n = space.dimension
    count = min(CANDIDATES[0] * n, CANDIDATES[1])
    from scipy.stats import qmc  # imported late: slow to load

    sobol = qmc.Sobol(n, scramble=True, rng=space.random).random_base2(math.ceil(math.log2(count)))[:count]
    spread = low + sobol * (high - low)
    moved = space.random.random((count, n)) < min(1.0, MOVED / n)
    still = ~moved.any(axis=1)
    moved[still, space.random.integers(n, size=int(still.sum()))] = True
    return np.where(moved, spread, centre)


def hypercube(count: int, space: Space) -> Floats:
    """A Latin hypercube of `count` points."""
    strata = space.random.permuted(np.tile(np.arange(count), (space.dimension, 1)), axis=1).T
    return (strata + space.random.random((count, space.dimension))) / count


def _moderate(costs: Floats) -> Floats:
    """Costs over a power of two, so that their squares are finite numbers; their order and digits stay."""
    _, exponent = np.frexp(np.abs(costs).max())
    return np.asarray(np.ldexp(costs, -exponent))


def _nearest(points: Floats, centre: Floats) -> NDArray[np.intp]:
    """Indices of the points nearest to the centre, in their order."""
    if len(points) <= MOST:
        return np.arange(len(points))
    distances = ((points - centre) ** 2).sum(axis=1)
    return np.sort(np.argsort(distances, kind="stable")[:MOST])


method = Method(
    name="turbo",
    title="TuRBO",
    kind="global",
    how="Global by restarts. A Gaussian process in a trust region",
    source="Eriksson et al. 2019",
    evaluations=300,
    options=Options,
    search=search,
    repeats=True,
    costly=True,
    extend=lambda options, more: options,
    family="Gaussian process",
    whole_budget=True,
    parallel="as stated",
    at_once="batch",
    suits="evaluations of 20 ms and more, many valleys, up to a thousand",
    look=MethodLook(colour="#a4262c", dark="#f07a7a", marker="hourglass"),
)
