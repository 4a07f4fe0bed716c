"""Stores that fail after a number of writes, and the outcome of a run."""

from __future__ import annotations

from typing import Any

from campaigns.results import Verdict
from campaigns.stored.records import Ahead, Columns, join
from tests.given.sampled_stages import DRAWN
from worker.running.runs.store import MemoryStore


class Interrupted(Exception):
    pass


class Unreliable(MemoryStore):
    """Raises after so many evaluations were stored."""

    def __init__(self, left: int) -> None:
        super().__init__(sample_seed=DRAWN)
        self.left = left

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        super().append(position, first, columns, ahead)
        self.left -= len(columns.status)
        if self.left <= 0:
            self.left = 10**9
            raise Interrupted


def outcome(store: MemoryStore, conclusion: Verdict) -> Any:
    """All that a run found, without the time it took."""
    columns = [join(store.chunks.get(k, [])) for k in range(len(store.stages))]
    return (
        conclusion,
        [None if r.result is None else without_time(r.result.model_dump()) for r in store.stages],
        [without_time(f.model_dump()) for f in store.findings],
        [
            None if c is None else (c.points.tobytes(), c.costs.tobytes(), c.status.tobytes(), c.reasons)
            for c in columns
        ],
        {name: (t.data.tobytes(), t.meta) for name, t in store.traces.items()},
    )


def without_time(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: without_time(v) for k, v in value.items() if k != "seconds"}
    return [without_time(v) for v in value] if isinstance(value, list) else value
