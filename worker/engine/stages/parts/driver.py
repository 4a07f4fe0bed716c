"""The driver of a stage: counts evaluations, answers repeated points from memory, and stores results.

It stops at the budget, tracks the best point, and replays the stored evaluations of a resumed stage. Start reading at
`Driver.answer`; `slot_driver` is that of systems with slots.
"""

from __future__ import annotations

import time
from collections.abc import Container

import numpy as np

from campaigns.results.base import EXCLUDED, OK, Stop
from campaigns.stored.records import Ahead, Columns, join
from worker.engine.search.base import Batch, Several
from worker.engine.stages.parts.context import (
    Cancelled,
    Context,
    Driven,
    ReplayMismatch,
    Request,
    Seeded,
    Tally,
    Through,
)
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, Seeds, System

FLUSH_SECONDS = 0.2
FLUSH_ROWS = 4096
FULL_BLOCKS = 16
"""Minimum number of points per call for a system that evaluates in blocks."""


class Driver:
    """Drives one stage of a system that evaluates batches."""

    def __init__(self, context: Context, position: int, budget: int, repeats: bool) -> None:
        self.context, self.position, self.budget = context, position, budget
        self.tally = Tally()
        self.known: dict[bytes, tuple[Floats, int]] | None = {} if repeats else None
        self.evaluated: list[Columns] = []
        self.unsaved: list[Columns] = []
        self.stored = context.store.evaluations(position)
        earlier = self.stored.seconds if self.stored is not None else np.empty(0)
        self.offset = float(earlier.max(initial=0.0))
        self.began = self.saved = time.perf_counter()

    def answer(self, request: Request) -> tuple[Batch, bool]:
        """The batch for these points, and whether the budget ended before all were evaluated."""
        if isinstance(request, Several):
            raise TypeError("a search requested several groups of a system without slots")
        if isinstance(request, Through):
            return self._fresh(request.points, through=request.system)
        points, seeds = request if isinstance(request, Seeded) else (request, None)
        if self.known is None:
            return self._fresh(points, seeds)
        keys = keys_of(points, seeds)
        distinct = unknown(keys, self.known)
        if distinct:
            batch, spent = self._fresh(points[distinct], None if seeds is None else seeds[distinct])
            for i, cost, status in zip(distinct, batch.costs, batch.status, strict=False):
                self.known[keys[i]] = (cost, int(status))
            if spent:
                return batch, True
        rows = [self.known[key] for key in keys]
        return Batch(np.array([r[0] for r in rows]), np.array([r[1] for r in rows], dtype=np.uint8)), False

    def end(self, how: Stop) -> Driven:
        if self.stored is not None and self.tally.evaluations < len(self.stored.status):
            raise ReplayMismatch(self.position, self.tally.evaluations)
        self.flush()
        self.tally.seconds = self._seconds()
        columns = join(self.evaluated)
        if columns is not None:
            self.context.columns[self.position] = columns
        return Driven(self.tally, columns, how)

    def flush(self) -> None:
        self._store(join(self.unsaved))
        self.saved = time.perf_counter()
        self.context.progress(self.position, self.tally)

    def _store(self, columns: Columns | None, ahead: Ahead | None = None) -> None:
        """Write what is not stored yet: the evaluations that continue the record, and those ahead of it."""
        if columns is not None:
            first = self.tally.evaluations - len(columns.status)
            self.unsaved = []  # even on error: the store may have written them before it raised
            self.context.store.append(self.position, first, columns, *([] if ahead is None else [ahead]))

    def _fresh(self, points: Floats, seeds: Seeds | None = None, through: System | None = None) -> tuple[Batch, bool]:
        room = self.budget - self.tally.evaluations
        spent = len(points) >= room and len(points) > 0
        points = points[:room]
        ended: list[Columns] = []
        done = 0
        while done < len(points):
            if self.context.cancelled():
                raise Cancelled
            piece = slice(done, done + self._piece())
            own = None if seeds is None else seeds[piece]
            ended.append(self._stored(points[done:]) or self._flown(points[piece], own, through))
            done += len(ended[-1].status)
        if (all_ended := join(ended)) is None:
            return Batch(np.empty((0, 1)), np.empty(0, dtype=np.uint8)), spent
        return Batch(all_ended.costs, all_ended.status), spent

    def _stored(self, points: Floats) -> Columns | None:
        """The next evaluations as stored by an earlier attempt, if any are left."""
        index = self.tally.evaluations
        if self.stored is None or index >= len(self.stored.status):
            return None
        count = min(len(points), len(self.stored.status) - index)
        rows = slice(index, index + count)
        if not np.array_equal(self.stored.points[rows], points[:count]):
            raise ReplayMismatch(self.position, index)
        reasons = {i: why for i, why in self.stored.reasons.items() if index <= i < index + count}
        stored = self.stored
        columns = Columns(stored.points[rows], stored.costs[rows], stored.status[rows], stored.seconds[rows], reasons)
        self._count(columns)
        return columns

    def _flown(self, points: Floats, seeds: Seeds | None, through: System | None) -> Columns:
        began = time.perf_counter()
        evaluate = self.context.evaluate
        if through is not None:
            batch, reasons = through.evaluate(self.context.problem.vectors(points))
        else:
            batch, reasons = evaluate(points) if seeds is None else evaluate(points, seeds)
        self.context.problem.system.cost = max(time.perf_counter() - began, 1e-6) / len(points)
        first = self.tally.evaluations
        seconds = np.full(len(points), self._seconds())
        columns = Columns(points, batch.costs, batch.status, seconds, {first + i: why for i, why in reasons.items()})
        self.unsaved.append(columns)
        self._count(columns)
        self._flush_if_due()
        return columns

    def _flush_if_due(self) -> None:
        rows = sum(len(c.status) for c in self.unsaved)
        if rows >= FLUSH_ROWS or time.perf_counter() - self.saved >= FLUSH_SECONDS:
            self.flush()

    def _piece(self) -> int:
        """Points per call, so that cancellation is checked and results are stored at the interval for storing."""
        system = self.context.problem.system
        least = FULL_BLOCKS * (optional.settings(system).lanes or 0) or 1
        return (
            least if system.cost is None else int(np.clip(FLUSH_SECONDS / system.cost, least, FULL_BLOCKS * FLUSH_ROWS))
        )

    def _count(self, columns: Columns) -> None:
        tally, first = self.tally, self.tally.evaluations
        self.evaluated.append(columns)
        tally.evaluations += len(columns.status)
        tally.failed += int(np.count_nonzero((columns.status != OK) & (columns.status != EXCLUDED)))
        tally.excluded += int(np.count_nonzero(columns.status == EXCLUDED))
        tally.seconds = self._seconds()
        ranked = columns.ranked()
        row = int(np.argmin(ranked))
        if np.isfinite(ranked[row]) and (tally.best is None or ranked[row] < tally.best):
            tally.best, tally.best_index = float(ranked[row]), first + row
            tally.best_point = columns.points[row].copy()

    def _seconds(self) -> float:
        return self.offset + time.perf_counter() - self.began


def keys_of(points: Floats, seeds: Seeds | None) -> list[bytes]:
    """What distinguishes requests: the point, and its seed if it has one."""
    if seeds is None:
        return [point.tobytes() for point in points]
    return [point.tobytes() + seed.tobytes() for point, seed in zip(points, seeds, strict=True)]


def unknown(keys: list[bytes], known: Container[bytes]) -> list[int]:
    """The first request of each point that is not known yet, in their order."""
    return sorted({key: i for i, key in reversed([*enumerate(keys)]) if key not in known}.values())
