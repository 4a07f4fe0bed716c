"""The driver of a stage whose system evaluates in slots: results arrive in any order and are stored as they do."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

from campaigns.results.base import Stop
from campaigns.stored.records import Ahead, Columns
from worker.engine.search.base import Batch, Several
from worker.engine.stages.parts.context import Cancelled, Context, Driven, ReplayMismatch, Request, Seeded, Through
from worker.engine.stages.parts.driver import Driver, keys_of, unknown
from worker.engine.stages.parts.in_slots import InSlots
from worker.engine.systems.base import Floats, Seeds, System


class SlotDriver(Driver):
    """Drives one stage: all points of a request are handed out at once, and groups are answered one by one."""

    def __init__(self, context: Context, position: int, budget: int, repeats: bool) -> None:
        super().__init__(context, position, budget, repeats)
        ahead = context.store.ahead(position)
        self.slots = InSlots(context.problem, position, self._piece, self._seconds, self.stored, ahead)
        self.offset = self.slots.last
        self.places: dict[bytes, int] | None = {} if repeats else None
        """The index of each point that was requested, where a search may request it again."""
        self.groups: dict[int, list[int]] = {}
        """The indices of each group of `Several` that was not answered yet."""
        self.taken = 0

    def answer(self, request: Request) -> tuple[Batch, bool]:
        if isinstance(request, Several):
            return self._first_of(request)
        if isinstance(request, Through):
            indices, spent = self._ask(request.points, None, request.system)
        else:
            points, seeds = request if isinstance(request, Seeded) else (request, None)
            indices, spent = self._indices(points, seeds)
        self._until_ended(indices)
        return self.slots.batch(indices), spent

    def end(self, how: Stop) -> Driven:
        if self.slots.left:
            raise ReplayMismatch(self.position, len(self.slots.rows))
        return super().end(how)

    def _store(self, columns: Columns | None, ahead: Ahead | None = None) -> None:
        ahead = self.slots.ahead()
        if columns is None and len(ahead.indices):
            columns = self.slots.columns(())
        super()._store(columns, ahead)

    def _first_of(self, request: Several) -> tuple[Batch, bool]:
        """The batch of the group that is complete first; the other groups continue."""
        for number, points in request.groups:
            self.groups[number], spent = self._indices(points, None)
            if spent:
                self._until_ended(range(len(self.slots.rows)))
                return self.slots.batch(()), True
        self._wait_until(lambda: self._complete() is not None)
        request.answered = number = self._complete() or 0
        return self.slots.batch(self.groups.pop(number)), False

    def _complete(self) -> int | None:
        """The group that was complete first; None while none is."""
        times = {number: self.slots.ended(indices) for number, indices in self.groups.items()}
        ready = [(at, number) for number, at in times.items() if at is not None]
        return min(ready)[1] if ready else None

    def _indices(self, points: Floats, seeds: Seeds | None) -> tuple[list[int], bool]:
        """Request what is not known yet: the indices of the points, and whether the budget is used up by them."""
        if self.places is None:
            return self._ask(points, seeds)
        keys = keys_of(points, seeds)
        new = unknown(keys, self.places)
        fresh, spent = self._ask(points[new], None if seeds is None else seeds[new])
        self.places.update(zip((keys[i] for i in new), fresh, strict=False))
        return [self.places[key] for key in keys if key in self.places], spent

    def _ask(self, points: Floats, seeds: Seeds | None, through: System | None = None) -> tuple[list[int], bool]:
        """Request points as far as the budget goes: their indices, and whether it is used up by them."""
        room = self.budget - len(self.slots.rows)
        spent = len(points) >= room and len(points) > 0
        return list(self.slots.ask(points[:room], None if seeds is None else seeds[:room], through)), spent

    def _until_ended(self, indices: Sequence[int]) -> None:
        for index in indices:
            self._wait_until(partial(self.slots.has, index))
        self._record()

    def _wait_until(self, true: Callable[[], bool]) -> None:
        while not true():
            if self.context.cancelled():
                raise Cancelled
            self.slots.wait()
            self._record()

    def _record(self) -> None:
        """Count what continues the record, and store what is due."""
        for columns, kept in self.slots.recorded():
            if not kept:
                self.unsaved.append(columns)
            self._count(columns)
        self._measure()
        self._flush_if_due()

    def _measure(self) -> None:
        ended, elapsed = self.slots.ended_here, time.perf_counter() - self.began
        if ended > self.taken:
            self.taken = ended
            self.context.problem.system.cost = max(elapsed, 1e-6) / ended
