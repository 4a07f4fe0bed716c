"""The best so far of a stage, read from its chunks as they arrive. Start reading at `Improvements.catch_up`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sqlalchemy as sa

from backend.db.tables import EvaluationChunk
from backend.results import thin


@dataclass
class Improvements:
    """Every evaluation of one stage that was lower than all before it, as columns."""

    index: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    """Working time of the stage [s]."""
    cost: list[float] = field(default_factory=list)
    read: int = 0
    """How many evaluations were looked at."""
    elapsed: float = 0.0
    """Working time at the last of them [s]."""

    def catch_up(self, reader: sa.Connection, run_id: int, position: int) -> None:
        """Read the chunks that were not read before."""
        chunk = EvaluationChunk
        query = sa.select(chunk.first, chunk.count, chunk.costs, chunk.status, chunk.seconds)
        of = (chunk.run_id == run_id, chunk.position == position, chunk.first >= self.read)
        for row in reader.execute(query.where(*of).order_by(chunk.first)):
            self._add(row)

    def _add(self, chunk: Any) -> None:
        costs = np.frombuffer(chunk.costs, dtype="<f8").reshape(chunk.count, -1)[:, 0]
        costs = np.where(np.frombuffer(chunk.status, dtype=np.uint8) == 0, costs, np.nan)
        seconds = np.frombuffer(chunk.seconds, dtype="<f8")
        better = thin.improvements(costs, self.cost[-1] if self.cost else np.inf)
        self.index += (chunk.first + better).tolist()
        self.seconds += seconds[better].tolist()
        self.cost += costs[better].tolist()
        self.read, self.elapsed = chunk.first + chunk.count, float(seconds[-1])
