"""What a search with restarts has evaluated, and where its next descent begins.

A star comes first: the centre of the box and two points on each axis through it, a third of the side away, with which
DIRECT begins too (Jones, Perttunen, Stuckman 1993). Further stars are around the lowest point, with two random values
on each axis. After a star, one point takes the better value on every axis where there is one: where parameters act
nearly one by one, it is lower than any of them. A space-filling sample of the box (scrambled Sobol points) fills free
slots, and grows when every point of stars and sample is near to what earlier descents explored.

As in MLSL (Rinnooy Kan and Timmer, Math. Program. 39, 1987), a descent begins at the lowest point of stars and sample
that is neither near to a lower evaluation nor to where a descent began or ended. Near means: not farther than a part of
the mean distance of random points, as many as these, to their nearest neighbour.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Generator
from typing import Any

import numpy as np

from worker.engine.search.base import Batch, Floats, Space

# Set on `tests.given.small_budget_valleys`.
NEAR, NEAREST = 0.6, 0.25
"""The part of the mean distance that is near, and the largest distance that is."""
BESIDE = 0.15
"""A star has no value nearer to its middle than this, in sides of the box: a descent has explored what is."""


class Explored:
    """All evaluated points (m, n) with their values (m,), infinite where there is none; stars and sample among them.

    The points of a request are a multiple of `at_once`.
    """

    def __init__(self, space: Space, at_once: int = 1) -> None:
        self._random, self._at_once = space.random, at_once
        self._sobol: Any = None
        self.points, self.values = np.empty((0, space.dimension)), np.empty(0)
        self.sample, self.sampled = self.points, self.values
        self.visited = self.points
        """Where descents began and ended."""

    @property
    def lowest(self) -> float:
        """The lowest value; infinite if there is none."""
        return float(self.values.min(initial=np.inf))

    @property
    def spread(self) -> float:
        """How far the lowest value is below the median of stars and sample; 0 without values."""
        valued = self.sampled[np.isfinite(self.sampled)]
        with np.errstate(over="ignore"):  # infinite where costs are as large as floating-point numbers can be
            return float(np.median(valued)) - self.lowest if len(valued) else 0.0

    def begin(self) -> Generator[Floats, Batch, None]:
        """Evaluate the star around the centre of the box."""
        n = self.points.shape[1]
        centre = np.full((1, n), 0.5)
        arms = _arms(centre[0], np.tile([1 / 6, 5 / 6], (n, 1)))
        values = yield from self._evaluate(np.concatenate([centre, arms]))
        yield from self._join(centre[0], float(values[0]), arms, values[1 : 2 * n + 1])

    def star(self) -> Generator[Floats, Batch, None]:
        """Evaluate a star around the lowest point: on each axis one value of either half of what is not near."""
        n, low = self.points.shape[1], int(np.argmin(self.values))
        middle, cost = self.points[low].copy(), float(self.values[low])
        below, above = np.maximum(middle - BESIDE, 0.0), np.maximum(1.0 - middle - BESIDE, 0.0)
        drawn = (np.arange(2) + self._random.random((n, 2))) / 2 * (below + above)[:, None]
        jump = np.where(drawn < below[:, None], 0.0, (1.0 - above - below)[:, None])
        arms = _arms(middle, np.minimum(drawn + jump, 1.0))
        values = yield from self._evaluate(arms)
        yield from self._join(middle, cost, arms, values[: 2 * n])

    def _join(self, middle: Floats, cost: float, arms: Floats, values: Floats) -> Generator[Floats, Batch, None]:
        """Evaluate the point that takes the better value of a star on every axis that has one, if several have."""
        pairs = values.reshape(-1, 2)
        axes = np.flatnonzero(pairs.min(axis=1) < cost)
        if len(axes) > 1:
            joined = middle.copy()
            joined[axes] = arms[2 * axes + pairs[axes].argmin(axis=1), axes]
            yield from self._evaluate(joined[None])

    def grow(self, count: int) -> Generator[Floats, Batch, None]:
        """Evaluate further points of the sample, at least so many."""
        yield from self._evaluate(self._filling(-(-count // self._at_once) * self._at_once))

    def _evaluate(self, points: Floats) -> Generator[Floats, Batch, Floats]:
        """Evaluate points of a star or the sample; further ones of the sample fill the request. Returns all values."""
        if free := -len(points) % self._at_once:
            points = np.concatenate([points, self._filling(free)])
        batch = yield points.copy()
        values = batch.ranked()
        self.add(points, values)
        self.sample, self.sampled = np.concatenate([self.sample, points]), np.concatenate([self.sampled, values])
        return values

    def _filling(self, count: int) -> Floats:
        from scipy.stats import qmc  # imported late: slow to load

        if self._sobol is None:
            self._sobol = qmc.Sobol(self.points.shape[1], scramble=True, rng=self._random)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that their number is no power of two
            return np.asarray(self._sobol.random(count), dtype=np.float64)

    def add(self, points: Floats, values: Floats) -> None:
        """Points (m, n) that were evaluated, with their values (m,)."""
        self.points, self.values = np.concatenate([self.points, points]), np.concatenate([self.values, values])

    def visit(self, point: Floats) -> None:
        """A descent began or ended at a point (n,)."""
        self.visited = np.concatenate([self.visited, point[None]])

    def start(self) -> Floats | None:
        """The point (n,) at which the next descent begins; None if the sample must grow first."""
        near = min(NEAR * self.spacing(), NEAREST)
        for i in np.argsort(self.sampled, kind="stable"):
            if not np.isfinite(self.sampled[i]):
                return None
            taken = np.concatenate([self.visited, self.points[self.values < self.sampled[i]]])
            if np.sqrt(((taken - self.sample[i]) ** 2).sum(axis=1)).min(initial=np.inf) > near:
                return np.asarray(self.sample[i])
        return None

    def spacing(self) -> float:
        """Mean distance of random points, as many as stars and sample, to their nearest neighbour, without borders."""
        n, count = self.points.shape[1], max(len(self.sample), 1)
        return math.gamma(1 + 1 / n) / math.sqrt(math.pi) * math.exp((math.lgamma(1 + n / 2) - math.log(count)) / n)

    def around(self, centre: Floats, radius: float) -> tuple[Floats, Floats]:
        """The evaluated points within a radius of a centre, the nearest last, and their values."""
        distances = np.sqrt(((self.points - centre) ** 2).sum(axis=1))
        order = np.argsort(-distances, kind="stable")
        order = order[distances[order] <= radius]
        return self.points[order], self.values[order]


def _arms(middle: Floats, values: Floats) -> Floats:
    """The points (2 n, n) of a star: its middle (n,), with each of the values (n, 2) in its axis."""
    arms = np.repeat(middle[None], 2 * len(middle), axis=0)
    arms[np.arange(len(arms)), np.arange(len(arms)) // 2] = values.reshape(-1)
    return arms
