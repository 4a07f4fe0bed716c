"""One poller for all listeners, however many pages are open."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import AsyncGenerator

import anyio
import anyio.to_thread
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.outages import DatabaseOutage
from backend.db.space import Room
from backend.events.watch import Event, Isolated, Watch, identified
from backend.workers.schemas import Space, Still, WorkerOut, Workers
from backend.workers.service import workers

PERIOD = 0.25
"""Polling interval of the database [s]."""

HEARTBEAT = 15.0
"""A silent stream carries a beat this often, so that both ends notice when the other is gone [s]."""

BACKLOG = 256
"""A listener this many events behind is dropped; it reconnects and receives everything again."""

RETRY = "retry: 2000\n\n"
BEAT = ": still here\nevent: beat\ndata:\n\n"
"""A comment, which `clearance.client` reads, and an event: JavaScript sees no comments."""

_log = logging.getLogger(__name__)


class _Listener:
    """One stream. Its mark, the id of its events, is the time up to which it has received everything.

    Of several simultaneous events only the last has the new mark: a client that loses one receives them again.
    """

    def __init__(self, run_id: int | None, since: float | None = None) -> None:
        self.run_id, self.since = run_id, since
        self.greeted = False
        self.mark = "" if since is None else _mark(since)
        self.queue: asyncio.Queue[str | None] = asyncio.Queue(BACKLOG)

    def send_all(self, events: list[Event], at: float) -> None:
        """Send the full state in one piece; without an earlier mark all events have the new one."""
        self.greeted, before, self.mark = True, self.mark or _mark(at), _mark(at)
        texts = [event.text(before) for event in events[:-1]] + [event.text(self.mark) for event in events[-1:]]
        self._put("".join(texts) or f"{identified(self.mark)}\n")

    def send(self, events: list[Event], at: float = 0.0) -> None:
        wanted = [e for e in events if e.run_id is None or self._subscribes(e)]
        for event in wanted[:-1]:
            self._put(event.text(self.mark))
        for event in wanted[-1:]:
            self.mark = _mark(at)
            self._put(event.text(self.mark))

    def _subscribes(self, event: Event) -> bool:
        return event.name == "run" if self.run_id is None else event.run_id == self.run_id

    def end(self) -> None:
        while self.queue.full():
            self.queue.get_nowait()
        self.queue.put_nowait(None)

    def _put(self, text: str) -> None:
        if self.queue.full():
            self.end()
        else:
            self.queue.put_nowait(text)


class Hub:
    """Sends every change to the listeners; polls only while there are any."""

    def __init__(self, engine: sa.Engine, room: Room) -> None:
        self._engine, self._room, self._isolated = engine, room, Isolated()
        self._listeners: set[_Listener] = set()
        self._poller: asyncio.Task[None] | None = None
        self._ended = False
        self._thread = anyio.CapacityLimiter(1)  # separate from the threads that all requests share

    @property
    def listeners(self) -> int:
        return len(self._listeners)

    async def listen(self, run_id: int | None, since: float | None = None) -> AsyncGenerator[str]:
        """The stream of one listener: of a run, or of all runs' summaries; ends when the service stops.

        since: the mark of a reconnecting listener; it receives the runs that ended in the meantime.
        """
        listener = _Listener(run_id, since)
        self._listeners.add(listener)
        try:
            yield RETRY
            if self._ended:
                return
            if self._poller is None or self._poller.done():
                self._poller = asyncio.create_task(self._poll())
            while (text := await self._next(listener)) is not None:
                yield text
        finally:
            self._listeners.discard(listener)

    def stop(self) -> None:
        self._ended = True
        for listener in self._listeners:
            listener.end()

    async def close(self) -> None:
        self.stop()
        if self._poller is not None:
            self._poller.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._poller

    @staticmethod
    async def _next(listener: _Listener) -> str | None:
        try:
            async with asyncio.timeout(HEARTBEAT):
                return await listener.queue.get()
        except TimeoutError:
            return BEAT

    async def _poll(self) -> None:
        watch, roster = Watch(self._engine), Roster(self._engine, self._room)
        try:
            while self._listeners:
                try:
                    await self._look(watch, roster)
                except DatabaseOutage as error:
                    watch.close()  # its connection may be to a file that is no longer there
                    _log.warning("no event streams for now: %s", error)
                except Exception:  # the poller must survive: without it all streams would be silent
                    watch.close()
                    _log.exception("the database could not be read for the event streams; trying again")
                await asyncio.sleep(PERIOD)
        finally:
            watch.close()

    async def _look(self, watch: Watch, roster: Roster) -> None:
        listeners = list(self._listeners)
        runs = {x.run_id for x in listeners if x.run_id is not None}

        def look() -> list[Event]:
            moved = self._isolated.made("the list of workers", roster.look)
            return [*moved, *watch.look(runs, bool(moved))]

        events = await anyio.to_thread.run_sync(look, limiter=self._thread)
        for listener in listeners:
            if listener.greeted:
                listener.send(events, watch.at)
                continue
            state = [*roster.everything(), *watch.everything(listener.run_id)]
            if listener.run_id is None and listener.since is not None:
                state += await anyio.to_thread.run_sync(watch.ended, listener.since)
            listener.send_all(state, watch.at)


def _mark(at: float) -> str:
    return f"{at:.3f}"


READ_PERIOD = 1.0
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
        self._due = time.monotonic() + READ_PERIOD
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
