"""What a search with restarts has evaluated, and where its next descent begins.

A space-filling sample of the box (scrambled Sobol points) comes first and grows when every point of it is near to what
earlier descents explored. As in MLSL (Rinnooy Kan and Timmer, Math. Program. 39, 1987), a descent begins at the lowest
point of the sample that is neither near to a lower evaluation nor to where a descent began or ended. Near means: not
farther than the mean distance of random points, as many as the sample has, to their nearest neighbour. Start reading at
`Explored`.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Generator
from typing import Any

import numpy as np

from worker.search.base import Batch, Floats, Space


class Explored:
    """All evaluated points (m, n) with their values (m,), infinite where there is none; the sample among them."""

    def __init__(self, space: Space) -> None:
        self._random = space.random
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
        """How far the lowest value is below the median of the sample; 0 without values."""
        valued = self.sampled[np.isfinite(self.sampled)]
        with np.errstate(over="ignore"):  # infinite where costs are as large as floating-point numbers can be
            return float(np.median(valued)) - self.lowest if len(valued) else 0.0

    def grow(self, count: int) -> Generator[Floats, Batch, None]:
        """Evaluate further points of the sample."""
        from scipy.stats import qmc  # imported late: slow to load

        if self._sobol is None:
            self._sobol = qmc.Sobol(self.points.shape[1], scramble=True, rng=self._random)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that their number is no power of two
            points = np.asarray(self._sobol.random(count), dtype=np.float64)
        batch = yield points.copy()
        values = batch.ranked()
        self.add(points, values)
        self.sample, self.sampled = np.concatenate([self.sample, points]), np.concatenate([self.sampled, values])

    def add(self, points: Floats, values: Floats) -> None:
        """Points (m, n) that were evaluated, with their values (m,)."""
        self.points, self.values = np.concatenate([self.points, points]), np.concatenate([self.values, values])

    def visit(self, point: Floats) -> None:
        """A descent began or ended at a point (n,)."""
        self.visited = np.concatenate([self.visited, point[None]])

    def start(self) -> Floats | None:
        """The point (n,) at which the next descent begins; None if the sample must grow first."""
        near = self.spacing()
        for i in np.argsort(self.sampled, kind="stable"):
            if not np.isfinite(self.sampled[i]):
                return None
            taken = np.concatenate([self.visited, self.points[self.values < self.sampled[i]]])
            if np.sqrt(((taken - self.sample[i]) ** 2).sum(axis=1)).min(initial=np.inf) > near:
                return np.asarray(self.sample[i])
        return None

    def spacing(self) -> float:
        """Mean distance of random points, as many as the sample has, to their nearest neighbour, without borders."""
        n, count = self.points.shape[1], max(len(self.sample), 1)
        return math.gamma(1 + 1 / n) / math.sqrt(math.pi) * math.exp((math.lgamma(1 + n / 2) - math.log(count)) / n)

    def around(self, centre: Floats, radius: float) -> tuple[Floats, Floats]:
        """The evaluated points within a radius of a centre, the nearest last, and their values."""
        distances = np.sqrt(((self.points - centre) ** 2).sum(axis=1))
        order = np.argsort(-distances, kind="stable")
        order = order[distances[order] <= radius]
        return self.points[order], self.values[order]
