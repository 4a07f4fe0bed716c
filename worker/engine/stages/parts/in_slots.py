"""The evaluations of one stage in slots: they end in any order, the record has them in the order of the requests.

What ends before an earlier one waits next to the record (`Ahead`), stored as soon as it has ended. The times at which
evaluations ended are part of the record: with them a resumed stage gives its search the same order.
"""

from __future__ import annotations

import queue
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from functools import partial
from typing import NamedTuple

import numpy as np

from campaigns.stored.records import Ahead, Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.stages.parts.context import ReplayMismatch
from worker.engine.systems.base import Evaluated, Floats, Seeds, Slotted, System, slots

LOOK_SECONDS = 0.2
"""Interval at which cancellation is checked while nothing ends."""


class Row(NamedTuple):
    """An ended evaluation, and the working time of the stage at its end [s]."""

    evaluated: Evaluated
    seconds: float


class InSlots:
    """Hands points to the slots of a system in the order of the requests, and collects what ends.

    An evaluation is identified by its index in the stage, which is at `position`. most: how many may be handed out at a
    time; now: the working time of the stage [s]; stored, ahead: the evaluations of an earlier attempt.
    """

    def __init__(
        self,
        problem: Problem,
        position: int,
        most: Callable[[], int],
        now: Callable[[], float],
        stored: Columns | None = None,
        ahead: Ahead | None = None,
    ) -> None:
        self.problem, self.position, self.most, self.now = problem, position, most, now
        self.rows: list[Row | None] = []
        self.done = 0
        """Number of evaluations before the first that has not ended."""
        self.ended_here = 0
        """Number of evaluations that ended in this process, not in an earlier attempt."""
        self._points: list[Floats] = []
        self._todo: deque[tuple[int, Callable[[], Future[Evaluated]]]] = deque()
        self._running = 0
        self._ended: queue.SimpleQueue[tuple[int, Future[Evaluated]]] = queue.SimpleQueue()
        self._stored = dict(_stored(stored, ahead))
        self.last = max((row.seconds for _, row in self._stored.values()), default=0.0)
        """When the latest evaluation ended, also of an earlier attempt [s]."""
        self._unstored: list[int] = []
        """Indices of the evaluations that ended here since the last call of `ahead`."""
        self._prefix = 0 if stored is None else len(stored.status)

    def ask(self, points: Floats, seeds: Seeds | None = None, through: System | None = None) -> range:
        """Request points (m, n), each under its own seed if given; their indices; or `ReplayMismatch`.

        through: the form of the system that evaluates them, which is used only until they have ended.
        """
        first = len(self.rows)
        system = through or self.problem.system
        vectors = self.problem.vectors(points)
        for k, point in enumerate(points):
            self._points.append(point.copy())
            known = self._stored.pop(first + k, None)
            if known is None:
                self.rows.append(None)
                seed = None if seeds is None else int(seeds[k])
                self._todo.append((first + k, partial(_started, system, vectors[k], seed)))
                continue
            before, row = known
            if not np.array_equal(before, point):
                raise ReplayMismatch(self.position, first + k)
            self.rows.append(row)
        self._hand_out()
        return range(first, len(self.rows))

    def wait(self) -> None:
        """Return when an evaluation has ended, or after a while."""
        try:
            self._take(*self._ended.get(timeout=LOOK_SECONDS))
            while True:
                self._take(*self._ended.get_nowait())
        except queue.Empty:
            self._hand_out()

    @property
    def left(self) -> bool:
        """Whether evaluations of an earlier attempt were not requested again."""
        return bool(self._stored)

    def has(self, index: int) -> bool:
        """Whether this evaluation has ended."""
        return self.rows[index] is not None

    def ended(self, indices: Sequence[int]) -> float | None:
        """When the last of these ended, in the working time of the stage [s]; None unless all have."""
        times = [row.seconds for row in (self.rows[i] for i in indices) if row is not None]
        return max(times, default=0.0) if len(times) == len(indices) else None

    def batch(self, indices: Sequence[int]) -> Batch:
        """The results of ended evaluations, in this order."""
        rows = [row.evaluated for row in (self.rows[i] for i in indices) if row is not None]
        costs = np.array([row.costs for row in rows]).reshape(len(rows), len(self.problem.results))
        return Batch(costs, np.array([row.status for row in rows], dtype=np.uint8))

    def recorded(self) -> list[tuple[Columns, bool]]:
        """The evaluations that continue the record, as columns, and whether the store's record has them already."""
        first = self.done
        while self.done < len(self.rows) and self.rows[self.done] is not None:
            self.done += 1
        middle = min(max(first, self._prefix), self.done)
        parts = [(range(first, middle), True), (range(middle, self.done), False)]
        return [(self.columns(part), kept) for part, kept in parts if part]

    def ahead(self) -> Ahead:
        """The ended evaluations behind a gap that the store does not have yet; it is assumed to store them."""
        new, self._unstored = sorted(i for i in self._unstored if i >= self.done), []
        return Ahead(np.array(new, dtype=np.int64), self.columns(new))

    def columns(self, indices: Sequence[int]) -> Columns:
        """Ended evaluations as columns."""
        rows = [row for row in (self.rows[i] for i in indices) if row is not None]
        batch = self.batch(indices)
        points = np.array([self._points[i] for i in indices]).reshape(len(rows), self.problem.dimension)
        reasons = {i: row.evaluated.reason for i, row in zip(indices, rows, strict=True) if row.evaluated.reason}
        return Columns(points, batch.costs, batch.status, np.array([row.seconds for row in rows]), reasons)

    def _hand_out(self) -> None:
        """Keep the slots busy, and no more than can be stored or cancelled promptly."""
        most = max(self.most(), 2 * slots(self.problem.system))
        while self._todo and self._running < most:
            index, start = self._todo.popleft()
            self._running += 1
            start().add_done_callback(partial(self._put, index))

    def _put(self, index: int, future: Future[Evaluated]) -> None:
        self._ended.put((index, future))

    def _take(self, index: int, future: Future[Evaluated]) -> None:
        self._running -= 1
        self.ended_here += 1
        self.last = float(max(np.nextafter(self.last, np.inf), self.now()))  # the order can be read from the times
        self.rows[index] = Row(future.result(), self.last)
        self._unstored.append(index)


def _started(system: System, vector: Floats, seed: int | None) -> Future[Evaluated]:
    """The evaluation of one vector (size,); a system without slots has evaluated it when this returns."""
    if isinstance(system, Slotted) and system.slots:
        return system.submit(vector, seed)
    batch, reasons = system.evaluate(vector[None, :], None if seed is None else np.array([seed]))
    ended: Future[Evaluated] = Future()
    ended.set_result(Evaluated(batch.costs[0], int(batch.status[0]), reasons.get(0, "")))
    return ended


def _stored(stored: Columns | None, ahead: Ahead | None) -> list[tuple[int, tuple[Floats, Row]]]:
    found = []
    parts = [] if stored is None else [(range(len(stored.status)), stored)]
    parts += [] if ahead is None else [(ahead.indices.tolist(), ahead.columns)]
    for indices, columns in parts:
        for row, index in enumerate(indices):
            evaluated = Evaluated(columns.costs[row], int(columns.status[row]), columns.reasons.get(index, ""))
            found.append((index, (columns.points[row], Row(evaluated, float(columns.seconds[row])))))
    return found
