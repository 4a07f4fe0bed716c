"""Read-only connections of requests: a few at a time, fewer of one user.

A request holds its connection while it waits for one of the threads that all requests share. If more requests held one
than there are, those threads would wait for connections and the connections for threads: the whole service would stop.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

import sqlalchemy as sa
from anyio import CancelScope, CapacityLimiter, to_thread

from backend.db.engine import read

AT_ONCE = 10
"""Requests with a connection; the engine has 15, the others are for endpoints that open one themselves."""
AT_ONCE_EACH = 5
"""The same of one user, so that whoever asks much is in nobody's way."""


@dataclass
class _Queue:
    turns: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(AT_ONCE_EACH))
    inside: int = 0


class Readers:
    """The connections in use; used on one event loop."""

    def __init__(self) -> None:
        self._turns, self._threads = asyncio.Semaphore(AT_ONCE), CapacityLimiter(AT_ONCE)
        self._queues: dict[str, _Queue] = {}

    @asynccontextmanager
    async def connection(self, engine: sa.Engine, account: str) -> AsyncIterator[sa.Connection]:
        """A connection with one snapshot, when it is this user's turn."""
        queue = self._queues.setdefault(account, _Queue())
        queue.inside += 1
        try:
            async with queue.turns, self._turns:
                reading = read(engine)
                connection = await to_thread.run_sync(reading.__enter__, limiter=self._threads)
                try:
                    yield connection
                finally:
                    with CancelScope(shield=True):
                        await to_thread.run_sync(reading.__exit__, None, None, None, limiter=self._threads)
        finally:
            queue.inside -= 1
            if not queue.inside:
                del self._queues[account]
