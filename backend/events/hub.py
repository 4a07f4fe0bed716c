"""One poller for all listeners, however many pages are open. Start reading at `Hub.listen`."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncGenerator

import anyio
import anyio.to_thread
import sqlalchemy as sa

from backend.events.watch import Event, Watch

PERIOD = 0.25
"""Time between looks at the database [s]."""

HEARTBEAT = 15.0
"""A silent stream carries a comment this often, so that both ends notice when the other is gone [s]."""

BACKLOG = 256
"""A listener this many events behind is dropped; it connects again and is told everything anew."""

RETRY = "retry: 2000\n\n"
COMMENT = ": still here\n\n"
_log = logging.getLogger(__name__)


class _Listener:
    def __init__(self, run_id: int | None) -> None:
        self.run_id = run_id
        self.greeted = False
        self.queue: asyncio.Queue[str | None] = asyncio.Queue(BACKLOG)

    def tell(self, events: list[Event]) -> None:
        for event in events:
            if event.name == "run" if self.run_id is None else event.run_id == self.run_id:
                self._put(event.text())

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
    """Hands every change to those who listen; polls only while somebody does."""

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine
        self._listeners: set[_Listener] = set()
        self._poller: asyncio.Task[None] | None = None
        self._ended = False
        self._thread = anyio.CapacityLimiter(1)  # not one of those that all requests share

    @property
    def listeners(self) -> int:
        """How many streams are open."""
        return len(self._listeners)

    async def listen(self, run_id: int | None) -> AsyncGenerator[str]:
        """The stream of one listener: of a run, or of all runs' summaries; ends when the service stops."""
        listener = _Listener(run_id)
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
        """End every stream; new ones end at once."""
        self._ended = True
        for listener in self._listeners:
            listener.end()

    async def close(self) -> None:
        """Stop and wait for the poller."""
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
            return COMMENT

    async def _poll(self) -> None:
        watch = Watch(self._engine)
        try:
            while self._listeners:
                try:
                    await self._look(watch)
                except sa.exc.SQLAlchemyError:
                    _log.exception("the database could not be read for the event streams; trying again")
                await asyncio.sleep(PERIOD)
        finally:
            watch.close()

    async def _look(self, watch: Watch) -> None:
        listeners = list(self._listeners)
        runs = {x.run_id for x in listeners if x.run_id is not None}
        events = await anyio.to_thread.run_sync(watch.look, runs, limiter=self._thread)
        for listener in listeners:
            listener.tell(events if listener.greeted else watch.everything(listener.run_id))
            listener.greeted = True
