"""Detects changes of the workers: one that starts, stops, falls silent, or goes to another run or stage.

Read by time, because a worker that falls silent commits nothing.
"""

from __future__ import annotations

import time

import sqlalchemy as sa

from backend.db.engine import read
from backend.db.space import Room
from backend.events.watch import Event
from backend.workers.schemas import Space, Still, WorkerOut, Workers
from backend.workers.service import workers

PERIOD = 1.0
"""How often the heartbeats are read [s]."""
STEP = 100_000_000
"""Free space is reported when it passes a multiple of this [bytes]."""


class Roster:
    def __init__(self, engine: sa.Engine, room: Room) -> None:
        self._engine, self._room = engine, room
        self._seen: Workers | None = None
        self._due = 0.0

    def look(self) -> list[Event]:
        """An event if more than the heartbeats has changed since the last reading; the first one is no change."""
        if time.monotonic() < self._due:
            return []
        self._due = time.monotonic() + PERIOD
        before = self._seen
        with read(self._engine) as reader:
            self._seen = workers(reader, self._room)
        return [] if before is None or _lasting(before) == _lasting(self._seen) else self.everything()

    def everything(self) -> list[Event]:
        """The first event of a new listener."""
        return [] if self._seen is None else [Event(None, "workers", self._seen.model_dump_json())]


def _lasting(seen: Workers) -> tuple[int, list[Still], Space, list[WorkerOut]]:
    free = None if seen.space.free is None else seen.space.free // STEP
    items = [w if w.state == "silent" else w.model_copy(update={"beat": 0.0}) for w in seen.items]
    return seen.queued, seen.still, seen.space.model_copy(update={"free": free, "short": bool(seen.space.short)}), items
