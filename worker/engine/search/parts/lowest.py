"""Tracks the lowest point of a search or of one of its descents, to report it as a minimum however the search ends."""

from __future__ import annotations

import numpy as np

from worker.engine.search.base import Floats, Minimum, Space


class Lowest:
    """The lowest point so far, its cost (infinity: none), and the number of evaluations."""

    def __init__(self, start: Floats | None = None) -> None:
        self.start = start
        self.point: Floats | None = None
        self.cost = np.inf
        self.evaluations = 0

    def see(self, points: Floats, values: Floats) -> None:
        """Update with points (m, n) and their values (m,), infinity if there is no value."""
        self.evaluations += len(points)
        low = int(np.argmin(values))
        if values[low] < self.cost:
            self.cost, self.point = float(values[low]), points[low].copy()

    def report(self, space: Space, text: str) -> None:
        """Report the lowest point as a minimum, if there is one."""
        if self.point is not None:
            space.report(Minimum(self.point, self.cost, self.start, self.evaluations, text))
