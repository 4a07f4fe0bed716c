"""What several searches that share a budget know together: where they were, what was lowest, where costs fall."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from worker.engine.search.base import Batch, Floats, Minimum, Space
from worker.engine.search.parts.descent import End
from worker.engine.search.parts.explored import Explored
from worker.engine.search.parts.portfolio_record import Record
from worker.engine.search.parts.trend import Trend


@dataclass
class Shared:
    """What the leading members know together: all points of the first part, and ever the lowest ones."""

    space: Space
    explored: Explored
    record: Record
    most: int
    """Points beyond which no descent is archived."""
    stale: int = 0
    """Evaluations since the last improvement."""
    lowest: float = np.inf
    best: Floats | None = None
    opened: bool = False
    """Whether the first descent has ended."""
    trend: Trend | None = None

    def see(self, points: Floats, values: Floats) -> None:
        """Points (m, n) of a leading member with their values (m,), infinite where failed."""
        low = int(np.argmin(values))
        self.stale += len(points)
        if values[low] < self.lowest:
            self.stale, self.lowest, self.best = 0, float(values[low]), points[low].copy()
        self.record.see(points, values)
        if self.trend:
            self.trend.see(points, values)

    def report(self, minimum: Minimum) -> None:
        """Record where a descent ended: no later one begins at a low point there, or where it began."""
        self.space.report(minimum)
        if minimum.start is not None:
            self.left(minimum.start, minimum.point)

    def left(self, start: Floats, end: Floats) -> None:
        """A descent has explored these two places (n,)."""
        for point in (start, end):
            self.explored.visit(point)
            self.record.take(point)
        self.opened = True

    def archived(self, descent: Generator[Floats, Batch, End]) -> Generator[Floats, Batch, End]:
        """A descent, whose points the model knows from then on; not beyond those that it can use."""
        try:
            points = next(descent)
            while True:
                batch = yield points
                if len(self.explored.points) < self.most:
                    self.explored.add(points.copy(), batch.ranked())
                points = descent.send(batch)
        except StopIteration as end:
            reached: End = end.value
            return reached
        finally:
            descent.close()
