"""The convergence history of a stage, read from its chunks as they arrive."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db.rows import as_array
from backend.db.tables import EvaluationChunk
from campaigns import thin

Floats = NDArray[np.float64]


@dataclass
class Improvements:
    """Every evaluation of one stage that was lower than all before it, as columns."""

    started: float | None = None
    """When the stage started; another time than before once the run was reset and begins again [s since 1970]."""
    index: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    """Working time of the stage [s]."""
    cost: list[float] = field(default_factory=list)
    read: int = 0
    """Number of evaluations read."""
    elapsed: float = 0.0
    """Working time when the last of them was completed [s]."""
    last: float = 0.0
    """Working time at the last of them by index [s]."""
    point: Floats | None = None
    """The best point (n,) on the unit cube."""

    def of(self, started: float | None) -> Improvements:
        """These, or empty ones for a stage that began again: what these were read from is discarded."""
        return self if started == self.started else Improvements(started)

    def catch_up(self, reader: sa.Connection, run_id: int, position: int) -> None:
        chunk = EvaluationChunk
        known = len(self.index)
        query = sa.select(chunk.first, chunk.count, chunk.costs, chunk.status, chunk.seconds)
        of = (chunk.run_id == run_id, chunk.position == position)
        for row in reader.execute(query.where(*of, chunk.first >= self.read).order_by(chunk.first)):
            self.add(row)
        if len(self.index) > known:
            # Only the best point is needed; the other points are not read.
            best = sa.select(chunk.first, chunk.count, chunk.points).where(*of, chunk.first <= self.index[-1])
            first, count, points = reader.execute(best.order_by(chunk.first.desc()).limit(1)).one()
            self.point = as_array(points, count)[self.index[-1] - first]

    def add(self, chunk: Any) -> None:
        """Read the next chunk: `first`, `count`, `costs`, `status`, `seconds`."""
        costs = as_array(chunk.costs, chunk.count)[:, 0]
        costs = np.where(np.frombuffer(chunk.status, dtype=np.uint8) == 0, costs, np.nan)
        seconds = np.frombuffer(chunk.seconds, dtype="<f8")
        better = thin.improvements(costs, self.cost[-1] if self.cost else np.inf)
        self.index += (chunk.first + better).tolist()
        self.seconds += seconds[better].tolist()
        self.cost += costs[better].tolist()
        self.last = float(seconds[-1])
        self.read, self.elapsed = chunk.first + chunk.count, max(self.elapsed, float(seconds.max()))
