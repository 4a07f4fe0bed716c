"""The information shared by the members of a portfolio: the spread of costs, and the lowest points found."""

from __future__ import annotations

from bisect import insort

import numpy as np

from worker.engine.search.base import Floats

APART = 0.05
"""Starts are at least this far (largest difference of a parameter) from earlier ones and from where those ended."""
KEPT = 256


class Record:
    """The lowest points away from all starts so far, and the first costs."""

    def __init__(self, dimension: int) -> None:
        self.dimension = dimension
        self.points: Floats = np.empty((0, dimension))
        self.values: Floats = np.empty(0)
        self.taken: Floats = np.empty((0, dimension))
        self.lowest = np.inf
        self.first: list[float] = []
        """In ascending order."""

    def see(self, points: Floats, values: Floats) -> None:
        """Update with points (m, n) and their values (m,), infinity if there is no value."""
        lowest = float(values.min())
        if lowest == np.inf:
            return
        self.lowest = min(self.lowest, lowest)
        if len(self.first) < 100 * self.dimension:
            for value in values[values < np.inf].tolist():
                insort(self.first, value)
        worst = self.values[-1] if len(self.values) == KEPT else np.inf
        if lowest >= worst:
            return
        some = np.flatnonzero(values < worst)
        some = some[self._free(points[some])]
        if len(some) == 1:
            self._insert(points[some], values[some])
        elif len(some):
            points, values = np.concatenate([self.points, points[some]]), np.concatenate([self.values, values[some]])
            order = np.argsort(values, kind="stable")[:KEPT]
            self.points, self.values = points[order], values[order]

    def _insert(self, point: Floats, value: Floats) -> None:
        """One point (1, n), after those that are equally low."""
        at, end = int(np.searchsorted(self.values, value[0], side="right")), KEPT - 1
        self.points = np.concatenate([self.points[:at], point, self.points[at:end]])
        self.values = np.concatenate([self.values[:at], value, self.values[at:end]])

    def spread(self) -> float:
        """The median of the first costs minus the lowest of all; 0 if there are no costs yet."""
        count = len(self.first)
        return (self.first[(count - 1) // 2] + self.first[count // 2]) / 2 - self.lowest if count else 0.0

    def lowest_start(self) -> float:
        """The cost of the next start; infinity if there is none."""
        return float(self.values[0]) if len(self.values) else float("inf")

    def start(self) -> Floats | None:
        """Take the lowest point (n,) away from all earlier starts as a start; None if there is none."""
        if len(self.points) == 0:
            return None
        chosen: Floats = self.points[0].copy()
        self.take(chosen)
        return chosen

    def take(self, point: Floats) -> None:
        """Exclude further starts near this point."""
        self.taken = np.concatenate([self.taken, point[None, :]])
        free = np.abs(self.points - point).max(axis=1) >= APART
        self.points, self.values = self.points[free], self.values[free]

    def _free(self, points: Floats) -> np.ndarray:
        if len(self.taken) == 0 or len(points) == 0:
            return np.ones(len(points), dtype=np.bool_)
        distance = np.abs(points[:, None, :] - self.taken[None, :, :]).max(axis=2)
        return np.asarray((distance >= APART).all(axis=1))
