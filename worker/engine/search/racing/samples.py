"""The sample from which contrast racing takes its starts: Sobol points, their values and their contrast.

The contrast of a point is its value minus the median value of its nearest neighbours in the sample: negative for a
point that is low within its neighbourhood.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels.cached import compiled
from worker.engine.search.base import Floats
from worker.engine.search.racing.state import inner

BLOCK = 1024
"""Number of Sobol points drawn at a time: a power of 2, as the sequence requires."""
CLOSEST = 1e-6
"""The smallest distance between starts."""


class Samples:
    """Points (m, n) in the order drawn, with values, neighbours and contrasts; reach: minimum distance of starts."""

    def __init__(self, dimension: int, neighbours: int, reach: float, random: np.random.Generator) -> None:
        self.dimension, self.neighbours, self.reach = dimension, neighbours, reach
        from scipy.stats import qmc  # imported late: a campaign's process must start fast

        self.sobol = qmc.Sobol(dimension, rng=random)
        self.ahead: Floats = np.empty((0, dimension))
        self.count = 0
        self.axes: Floats = np.empty((dimension, 1024))
        self.value: Floats = np.empty(1024)
        self.far: Floats = np.empty((1024, neighbours))
        self.around: Floats = np.empty((1024, neighbours))
        self.contrast: Floats = np.empty(1024)
        self.closed: NDArray[np.bool_] = np.empty(1024, dtype=np.bool_)
        self.starts: list[Floats] = []

    def draw(self, count: int) -> Floats:
        """The next points (count, n) of the scrambled Sobol sequence."""
        while len(self.ahead) < count:
            self.ahead = np.concatenate([self.ahead, self.sobol.random(BLOCK)])
        drawn, self.ahead = self.ahead[:count], self.ahead[count:]
        return drawn.copy()

    def add(self, points: Floats, values: Floats) -> None:
        """Add the points that have a value."""
        known = np.isfinite(values)
        points, values = points[known], values[known]
        first, last = self.count, self.count + len(points)
        while last > len(self.value):
            self._grow()
        self.axes[:, first:last] = points.T
        self.value[first:last] = values
        self.far[first:last] = np.inf
        self.around[first:last] = np.inf
        self.contrast[first:last] = 0.0
        self.count = last
        self._close(first)
        _update_neighbours(self.axes, self.value, self.far, self.around, self.contrast, first, last)

    def start(self, by_contrast: bool) -> tuple[Floats, float] | None:
        """Choose as a start the point (n,) of lowest contrast or value away from all starts; returns it and its value.

        If every point is close to a start, the minimum distance is halved. None if there are no points.
        """
        n = self.count
        while self.closed[:n].all():
            self.reach *= 0.5
            if self.reach < CLOSEST:
                return None
            self._close(0)
        score = np.where(self.closed[:n], np.inf, self.contrast[:n] if by_contrast else self.value[:n])
        chosen = int(np.argmin(score))
        point = self.axes[:, chosen].copy()
        self.starts.append(point)
        self.closed[:n] |= np.abs(self.axes[:, :n] - point[:, None]).max(axis=0) < self.reach
        return point, float(self.value[chosen])

    def _close(self, first: int) -> None:
        """Mark the points from `first` on that are close to a start as closed."""
        self.closed[first : self.count] = False
        for start in self.starts:
            near = np.abs(self.axes[:, first : self.count] - start[:, None]).max(axis=0) < self.reach
            self.closed[first : self.count] |= near

    def _grow(self) -> None:
        self.axes = np.concatenate([self.axes, np.empty_like(self.axes)], axis=1)
        for name in ("value", "far", "around", "contrast", "closed"):
            column = getattr(self, name)
            setattr(self, name, np.concatenate([column, np.empty_like(column)]))


@compiled
def _update_neighbours(
    axes: Floats, value: Floats, far: Floats, around: Floats, contrast: Floats, first: int, last: int
) -> None:
    """Update the nearest neighbours for the points from `first` on, and the contrasts that change.

    far (m, k) and around (m, k): squared distances of the nearest neighbours, in ascending order, and their values.
    """
    changed = np.empty(last, np.bool_)
    for i in range(last):
        changed[i] = False
    squared = np.empty(last)
    for j in range(max(first, 1), last):
        for i in range(j):
            squared[i] = 0.0
        for k in range(axes.shape[0]):
            x = axes[k, j]
            for i in range(j):
                squared[i] += (axes[k, i] - x) ** 2
        changed[j] = True
        for i in range(j):
            if squared[i] < far[i, -1]:
                _insert(far[i], around[i], squared[i], value[j])
                changed[i] = True
            if squared[i] < far[j, -1]:
                _insert(far[j], around[j], squared[i], value[i])
    for i in range(last):
        if changed[i]:
            known = 0
            while known < far.shape[1] and np.isfinite(far[i, known]):
                known += 1
            contrast[i] = value[i] - _median(around[i], known)


@inner
def _median(values: Floats, count: int) -> float:
    """The median of the first `count` values, which are few; NaN if there are none."""
    if count == 0:
        return np.nan
    ordered = np.empty(count)
    for i in range(count):
        j = i
        while j > 0 and ordered[j - 1] > values[i]:
            ordered[j] = ordered[j - 1]
            j -= 1
        ordered[j] = values[i]
    middle = count // 2
    return float(ordered[middle] if count % 2 else 0.5 * (ordered[middle - 1] + ordered[middle]))


@inner
def _insert(far: Floats, around: Floats, squared: float, value: float) -> None:
    """Insert one neighbour in order of distance; the farthest is dropped."""
    at = len(far) - 1
    while at > 0 and far[at - 1] > squared:
        far[at] = far[at - 1]
        around[at] = around[at - 1]
        at -= 1
    far[at] = squared
    around[at] = value
