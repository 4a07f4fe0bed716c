"""The sample of MLSL and its rule: where the next local searches begin.

Rinnooy Kan and Timmer, Stochastic global optimization methods II: multi level methods (Math. Programming 39, 1987),
with the constants of NLopt's program: sigma 2, gamma 0.3.
"""

from __future__ import annotations

import math

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.search.base import Floats
from worker.engine.search.racing.state import Ints

SIGMA, GAMMA = 2.0, 0.3
"""Of the critical distance; the fraction of the sample, the lowest, from which local searches may begin."""


class Levels:
    """Sample points (m, n) with their values (m,), the lowest first, and the local minima that are known."""

    def __init__(self, dimension: int) -> None:
        self.points, self.values = np.empty((0, dimension)), np.empty(0)
        self.nearest = np.empty(0)
        """(m,) squared distance to the nearest lower sample point or lower minimum."""
        self.begun = np.empty(0, dtype=np.int64)
        """(m,) 1 where a local search has begun."""
        self.sampled = 0
        """All points of the sample, those without a value too."""

    def add(self, points: Floats, values: Floats) -> None:
        """Further points (k, n) of the sample with their values (k,), infinite where there is none."""
        self.sampled += len(points)
        valued = np.isfinite(values)
        old, k = len(self.points), int(valued.sum())
        values = np.concatenate([self.values, values[valued]])
        order = np.argsort(values, kind="stable")
        self.points = np.concatenate([self.points, points[valued]])[order]
        self.values = values[order]
        self.nearest = np.concatenate([self.nearest, np.full(k, np.inf)])[order]
        self.begun = np.concatenate([self.begun, np.zeros(k, dtype=np.int64)])[order]
        _approach(self.points, self.nearest, np.flatnonzero(order >= old))

    def ended(self, point: Floats, value: float) -> None:
        """A local search has ended at a minimum (n,): no other begins near it above it."""
        squared = ((self.points - point) ** 2).sum(axis=1)
        self.nearest = np.where(self.values > value, np.minimum(self.nearest, squared), self.nearest)

    def starts(self, most: int) -> Ints:
        """The rows at which local searches begin, the lowest first; they count as begun."""
        lowest = slice(0, math.ceil(GAMMA * len(self.points)))
        free = (self.nearest[lowest] > self.critical() ** 2) & (self.begun[lowest] == 0)
        rows = np.flatnonzero(free)[:most]
        self.begun[rows] = 1
        return rows

    def critical(self) -> float:
        """The distance within which a lower point bars a local search."""
        n, m = self.points.shape[1], max(self.sampled, 2)
        volume: float = math.exp(math.lgamma(1 + n / 2) / n) * (SIGMA * math.log(m) / m) ** (1 / n)
        return volume / math.sqrt(math.pi)


@compiled
def _approach(points: Floats, nearest: Floats, new: Ints) -> None:
    """Update the distances to the nearest lower point for new rows among points in ascending order of their values."""
    m, n = points.shape
    for i in new:
        for j in range(m):
            if i == j:
                continue
            upper = max(i, j)
            squared = 0.0
            for k in range(n):
                squared += (points[i, k] - points[j, k]) ** 2
                if squared >= nearest[upper]:
                    break
            if squared < nearest[upper]:
                nearest[upper] = squared
