"""Where costs are lower than their trend over the box: beside a narrow valley, before any point is low.

The trend is a quadratic polynomial by least squares (response surface: Box and Wilson, J. Royal Statistical Society B
13, 1951) through points spread over the box, and the search looks at its residuals. Around the lowest residual it
evaluates points in a box, then in a smaller one around the lowest of those: the trend, which would lead a descent into
the wide valley again, is not part of what it compares.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.one_thread import one_thread

CELLS = 10
"""Of each parameter's range; a cell of the box keeps the first of its points."""
KEPT = 2000
AROUND, POINTS = (0.1, 0.1, 0.05), 6
"""Half the side of each box in which it looks closer; points there per parameter."""
APART = 0.05
"""Points where it looks are at least this far (largest difference of a parameter) from earlier ones."""
LEAST = 1e-6
"""A residual counts if it is below zero by this fraction of the deviation of the costs: others are rounding errors."""


class Trend:
    """Points spread over the box, and where their costs are below the trend."""

    def __init__(self, dimension: int) -> None:
        self._pairs = np.triu_indices(dimension)
        self._places = CELLS ** np.arange(dimension)
        self._filled: set[int] = set()
        self._points, self._values = np.empty((KEPT, dimension)), np.empty(KEPT)
        self._seen = np.empty((0, dimension))

    def see(self, points: Floats, values: Floats) -> None:
        """Points (m, n) with their values (m,), infinite where failed."""
        cells = np.minimum((points * CELLS).astype(np.int64), CELLS - 1) @ self._places
        for i, cell in enumerate(cells.tolist()):
            count = len(self._filled)
            if cell not in self._filled and count < KEPT and np.isfinite(values[i]):
                self._filled.add(cell)
                self._points[count], self._values[count] = points[i], values[i]

    def closer(self, random: np.random.Generator) -> Generator[Floats, Batch, Floats | None]:
        """Evaluate points around the lowest residual; the point (n,) that is lowest there, None without a trend."""
        coefficients = self._coefficients()
        if coefficients is None or (point := self._next(coefficients)) is None:
            return None
        lowest = np.inf
        for side in AROUND:
            drawn = 2.0 * random.random((POINTS * len(point), len(point))) - 1.0
            around = np.clip(point + side * drawn, 0.0, 1.0)
            values = (yield around.copy()).ranked()
            residuals = values - self._expected(around, coefficients)
            best = int(np.argmin(residuals))
            if residuals[best] < lowest:
                point, lowest = around[best], float(residuals[best])
        return point

    def _next(self, coefficients: Floats) -> Floats | None:
        """The point (n,) with the lowest residual that is away from earlier ones."""
        points, values = self._points[: len(self._filled)], self._values[: len(self._filled)]
        residuals = values - self._expected(points, coefficients)
        for i in np.argsort(residuals, kind="stable"):
            if not residuals[i] < -LEAST * values.std():
                return None
            if (np.abs(self._seen - points[i]).max(axis=1) >= APART).all():
                self._seen = np.concatenate([self._seen, points[i : i + 1]])
                return np.array(points[i])
        return None

    def _coefficients(self) -> Floats | None:
        """The coefficients of the polynomial; None with fewer than twice as many points, or costs too large to be
        squared."""
        count = len(self._filled)
        terms = self._terms(self._points[:count])
        if count < 2 * terms.shape[1] or np.abs(self._values[:count]).max() > 1e150:
            return None
        with one_thread():
            return np.asarray(np.linalg.lstsq(terms, self._values[:count], rcond=None)[0])

    def _expected(self, points: Floats, coefficients: Floats) -> Floats:
        """The trend at points (m, n)."""
        with one_thread():
            return np.asarray(self._terms(points) @ coefficients)

    def _terms(self, points: Floats) -> Floats:
        """One, every parameter and every product of two, of points (m, n)."""
        first, second = self._pairs
        return np.concatenate([np.ones((len(points), 1)), points, points[:, first] * points[:, second]], axis=1)
