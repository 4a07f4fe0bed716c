"""Sends the messages of the outbox while the service runs: one task for each target, so that none waits for another.

The database is read and written in a thread of its own; the event loop only waits for the network.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import ssl
import time
from collections.abc import Callable
from functools import partial
from typing import TypeVar

import anyio
import anyio.to_thread
import httpx
import sqlalchemy as sa

from backend.db.outages import DatabaseOutage
from backend.webhooks.configuration import Configured, Target
from backend.webhooks.outbox import Outbox
from backend.webhooks.sending import Message, Sent, send

Result = TypeVar("Result")

PERIOD = 1.0
"""Pause between two looks at the outbox [s]."""
_log = logging.getLogger(__name__)


class Dispatcher:
    """The tasks of the configured targets; without one it does nothing."""

    def __init__(self, engine: sa.Engine, configured: Configured, public_url: str = "") -> None:
        self.engine, self.configured, self.public_url = engine, configured, public_url
        self._tasks: list[asyncio.Task[None]] = []
        self._thread: anyio.CapacityLimiter | None = None
        self._tls: ssl.SSLContext | None = None

    async def start(self) -> None:
        if self.configured.targets:
            logging.getLogger("httpx").setLevel(logging.WARNING)  # it logs whole addresses, which may contain secrets
        self._thread = anyio.CapacityLimiter(2)
        self._tasks = [asyncio.create_task(self._serve(target)) for target in self.configured.targets]

    async def close(self) -> None:
        """Stop sending; an attempt that is cut off is repeated under the same id after the next start."""
        for task in self._tasks:
            task.cancel()
        for task in self._tasks:
            with contextlib.suppress(asyncio.CancelledError):
                await task

    async def _serve(self, target: Target) -> None:
        box = Outbox(self.engine, target.id, self.public_url)
        registered = False
        while True:
            try:
                if not registered:
                    await self._apart(box.register)
                    registered = True
                await self._apart(box.fill)
                while (message := await self._apart(box.claim)) is not None:
                    sent = await self._sent(target, message)
                    await self._apart(partial(box.record, message, sent))
                    if sent.error is not None:
                        _log.warning("webhook %s, attempt %d: %s", message.id, message.attempt, sent.error)
            except DatabaseOutage as error:
                _log.warning("no webhooks for now: %s", error)
            except Exception:  # the task must survive: without it no message would be sent, without any error
                _log.exception("the webhook of %s could not be served; trying again", target.origin)
            await asyncio.sleep(PERIOD)

    async def _sent(self, target: Target, message: Message) -> Sent:
        if self._tls is None:
            self._tls = await self._apart(httpx.create_ssl_context)  # reads the certificates of all authorities
        return await send(target, self.configured.key, message, int(time.time()), self._tls)

    async def _apart(self, work: Callable[[], Result]) -> Result:
        return await anyio.to_thread.run_sync(work, limiter=self._thread)
