"""Tracks the lowest point of a search or of one of its descents, to report it as a minimum however the search ends."""

from __future__ import annotations

import numpy as np

from worker.engine.search.base import Floats, Minimum, Space


class Lowest:
    """The lowest point so far, its cost (infinity: none), and the number of evaluations."""

    def __init__(self) -> None:
        self.point: Floats | None = None
        self.cost = np.inf
        self.evaluations = 0

    def see(self, points: Floats, values: Floats) -> None:
        """Update with points (m, n) and their values (m,), infinity if there is no value."""
        self.evaluations += len(points)
        low = int(np.argmin(values))
        if values[low] < self.cost:
            self.cost, self.point = float(values[low]), points[low].copy()


class Reported(Lowest):
    """A context whose lowest point, if there is one, is reported as a minimum at its end; `text`: how it ended."""

    def __init__(self, space: Space, start: Floats | None = None) -> None:
        super().__init__()
        self.space, self.start, self.text = space, start, "the search ended"

    def __enter__(self) -> Reported:
        return self

    def __exit__(self, *_: object) -> None:
        if self.point is not None:
            self.space.report(Minimum(self.point, self.cost, self.start, self.evaluations, self.text))
