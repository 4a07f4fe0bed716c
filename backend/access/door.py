"""Authenticates requests with its own threads and connections, so that it responds while the rest is busy.

Reading never waits for a writer. The use of a token is recorded in the background: the request neither waits for it
nor fails with it.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Any, TypeVar

import sqlalchemy as sa
from anyio import CapacityLimiter, to_thread
from starlette.requests import HTTPConnection

from backend.db import access, damage
from backend.db.access import Visitor
from backend.db.engine import ask, connect
from backend.db.outages import DatabaseOutage

Result = TypeVar("Result")

THREADS = 8
NOTE_PATIENCE = 0.2
"""How long recording a token's use may wait for other writers [s]."""
REMEMBERED = 10_000
"""Sessions of which the last use is known."""

_log = logging.getLogger(__name__)


class Door:
    """Visitors by their cookie or token; used on one event loop."""

    def __init__(self, database: str, cookie: str) -> None:
        self.cookie = cookie
        self._engine = connect(database)
        self._notes = connect(database, NOTE_PATIENCE)
        self._threads, self._health, self._noting = CapacityLimiter(THREADS), CapacityLimiter(2), CapacityLimiter(1)
        self._noted: dict[str, float] = {}
        self._used: dict[str, float] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._under_way: dict[str, asyncio.Task[Any]] = {}

    async def visitor(self, connection: HTTPConnection) -> Visitor | None:
        """The authenticated sender, or None. A header `Authorization` takes precedence over a cookie."""
        scheme, _, token = connection.headers.get("authorization", "").partition(" ")
        if scheme:
            return await self._by_token(token.strip()) if scheme.lower() == "bearer" else None
        cookie = connection.cookies.get(self.cookie)
        return await self._by_session(cookie) if cookie else None

    async def still(self, connection: HTTPConnection) -> bool:
        """Whether the sender is still authenticated; true if the database cannot be read."""
        try:
            return await self.visitor(connection) is not None
        except DatabaseOutage as error:
            _log.warning("a visitor's access could not be checked again; trying again later: %s", error)
            return True
        except sa.exc.SQLAlchemyError:
            _log.exception("a visitor's access could not be checked again; trying again later")
            return True

    async def healthy(self) -> None:
        """Returns once the database answers; raises `DatabaseOutage`, also if this process has met damage in it."""
        await self.inspected("health", self._well)

    async def inspected(self, name: str, question: Callable[[sa.Engine], Result]) -> Result:
        """For the health check, which is always answered: all that wait under one name get one question's answer."""
        task = self._under_way.get(name)
        if task is None or task.done():
            task = asyncio.ensure_future(to_thread.run_sync(question, self._engine, limiter=self._health))
            task.add_done_callback(lambda ended: ended.cancelled() or ended.exception())  # also if no request waits
            self._under_way[name] = task
        return await asyncio.shield(task)

    async def ask(self, question: Callable[[sa.Connection], Result]) -> Result:
        """Run a query; never waits for writers."""
        return await to_thread.run_sync(ask, self._engine, question, limiter=self._threads)

    async def close(self) -> None:
        """Close the connections, once those that record a use have ended: a connection that is in use is not closed."""
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._engine.dispose()
        self._notes.dispose()

    def _well(self, engine: sa.Engine) -> None:
        ask(engine, lambda reader: reader.execute(sa.select(1)))
        damage.refuse(engine)

    async def _by_token(self, token: str) -> Visitor | None:
        found = await self.ask(lambda reader: access.by_token(reader, token))
        if found is None:
            return None
        visitor, due = found
        at = time.monotonic()
        if due and at - self._noted.get(visitor.user, -access.USE_NOTED) >= access.USE_NOTED:
            self._noted[visitor.user] = at  # at most once a minute, even if writing fails
            self.later(lambda writer: access.note_use(writer, visitor.user))
        return visitor

    async def _by_session(self, cookie: str) -> Visitor | None:
        visitor = await self.ask(lambda reader: access.by_session(reader, cookie))
        if visitor is not None:
            self._used.pop(visitor.key, None)
            self._used[visitor.key] = float(int(time.time()))  # the last one of the order
            if len(self._used) > REMEMBERED:
                del self._used[next(iter(self._used))]
        return visitor

    def last_uses(self) -> dict[str, float]:
        """The last request of each session since the service started, by the session's id [s since 1970]."""
        return {key[: access.SESSION_ID]: at for key, at in self._used.items()}

    def later(self, work: Callable[[sa.Connection], None], failed: Callable[[], None] = lambda: None) -> None:
        """Write in the background, without waiting for other writers."""
        task = asyncio.create_task(self.write(work, failed))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def write(self, work: Callable[[sa.Connection], None], failed: Callable[[], None] = lambda: None) -> None:
        """Write; if the database is busy it is left, and `failed` is called."""

        def write() -> None:
            with self._notes.begin() as writer:
                work(writer)

        try:
            await to_thread.run_sync(write, limiter=self._noting)
        except sa.exc.SQLAlchemyError as error:
            _log.info("a use or a failed sign-in was not recorded: %s", type(error).__name__)
            failed()

    async def written(self) -> None:
        await asyncio.gather(*self._tasks, return_exceptions=True)
