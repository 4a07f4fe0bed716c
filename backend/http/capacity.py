"""Limits long work: a few jobs at a time in their own threads, a short queue, and 503 beyond it.

All other work runs in the 40 threads that requests share: long work there would block the whole service. Waiting jobs
wait on the event loop and occupy no thread.
"""

from __future__ import annotations

import asyncio
import functools
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any, TypeVar

from anyio import CancelScope, CapacityLimiter, to_thread
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from backend.http.errors import RefusedError

Result = TypeVar("Result")
Gone = Callable[[], Awaitable[bool]]


class Capacity:
    """Limits concurrent and waiting jobs of one kind; used on one event loop."""

    def __init__(
        self,
        doing: str,
        at_once: int,
        waiting: int,
        patience: float | None,
        retry: int,
        sentence: str = "",
        kind: str = "busy",
    ) -> None:
        """doing: such as "reports are being printed"; sentence: the whole refusal instead; kind: of the problem.

        patience, retry: longest wait, None for any, and Retry-After [s].
        """
        self.at_once, self.waiting, self.patience, self.retry = at_once, waiting, patience, retry
        self.kind, self.sentence = kind, sentence or f"{at_once} {doing}, and the queue is full: try again in {retry} s"
        self.inside = 0
        """The number of running and waiting jobs."""
        self._shares: dict[str, _Share] = {}
        self._turns = asyncio.Semaphore(at_once)
        self._threads = CapacityLimiter(at_once)

    async def run(self, account: str, work: Callable[[], Result], gone: Gone | None = None) -> Result:
        """Run the work in a thread when its turn comes. Raises `RefusedError` (503).

        account: as in `turn`.
        gone: whether the client has gone away; checked when the job's turn comes, so that no work is done for a closed
        connection.
        """
        async with self.turn(account):
            if gone is not None and await gone():
                raise RefusedError("busy", "the client closed the connection before the answer")
            return await self.thread(work)

    async def thread(self, work: Callable[[], Result]) -> Result:
        """Run a part of a job in a thread during its turn."""
        return await to_thread.run_sync(work, limiter=self._threads)

    @asynccontextmanager
    async def turn(self, account: str) -> AsyncIterator[None]:
        """The turn of one job; raises `RefusedError` (503) if the queue is full or the wait too long.

        account: whose job it is, who has at most half of the turns and of the queue, so that no user's program keeps
        all others out; empty before anybody has signed in.
        """
        self.refuse_full()
        async with self._share(account) as share:
            self.inside += 1
            try:
                async with AsyncExitStack() as turn_stack:
                    try:
                        async with asyncio.timeout(self.patience):
                            for turns in (share.turns, self._turns):
                                await turn_stack.enter_async_context(turns)
                    except TimeoutError:
                        raise self._busy() from None
                    yield
            finally:
                self.inside -= 1

    @asynccontextmanager
    async def _share(self, account: str) -> AsyncIterator[_Share]:
        """What an account has of the turns; all of them without one."""
        if not account:
            yield _Share(self.at_once)
            return
        share = self._shares.setdefault(account, _Share(max(self.at_once // 2, 1)))
        if share.inside >= max((self.at_once + self.waiting) // 2, 1):
            raise self._busy()
        share.inside += 1
        try:
            yield share
        finally:
            share.inside -= 1
            if not share.inside:
                del self._shares[account]

    def refuse_full(self) -> None:
        """Raise `RefusedError` (503) if the queue is full."""
        if self.inside >= self.at_once + self.waiting:
            raise self._busy()

    def _busy(self) -> RefusedError:
        return RefusedError(self.kind, self.sentence, headers={"Retry-After": str(self.retry)})


class _Share:
    """What one account has of the turns, and how many of its jobs run or wait."""

    def __init__(self, turns: int) -> None:
        self.turns, self.inside = asyncio.Semaphore(turns), 0


class BoundedStream(StreamingResponse):
    """A streamed file whose parts are generated in the capacity's threads; its turn ends after the last byte."""

    def __init__(self, capacity: Capacity, parts: Callable[[], Iterator[bytes]], account: str, **options: Any) -> None:
        super().__init__(iter(()), **options)
        self._capacity, self._parts, self._account = capacity, parts, account

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async with self._capacity.turn(self._account):
            parts = await self._capacity.thread(self._parts)  # refuse before the response starts
            self.body_iterator = self._each(parts)
            try:
                await super().__call__(scope, receive, send)
            finally:
                close = getattr(parts, "close", None)
                if close is not None:  # close the generator, which may hold a database connection
                    with CancelScope(shield=True):
                        await self._capacity.thread(close)

    async def _each(self, parts: Iterator[bytes]) -> AsyncIterator[bytes]:
        while (part := await self._capacity.thread(functools.partial(next, parts, None))) is not None:
            yield part


class Capacities:
    def __init__(self) -> None:
        # Read-only connections of requests; the engine has five more, for endpoints that open one themselves. A request
        # holds its own while it waits for a thread that all share: more of them would wait for each other without end.
        self.reads = Capacity("", 10, sys.maxsize, None, 1)
        self.pdf = Capacity("reports are being printed", 2, 4, 60.0, 30)
        self.recordings = Capacity("recordings are being made", 2, 6, 20.0, 5)
        self.files = Capacity("files are being written", 4, 12, 20.0, 5)
        self.checks = Capacity("campaigns are being checked", 8, 32, 20.0, 3)
        self.views = Capacity("3D views are being changed", 8, 64, 20.0, 1)
        self.cases = Capacity("case of a simulator is being evaluated", 1, 4, 60.0, 5)
        self.flights = Capacity("flights are being simulated", 4, 32, 20.0, 1)
        # The largest campaign takes seconds to parse, and threads share one interpreter.
        reading = "other campaigns are being read and the queue is full: try again in a few seconds"
        self.bodies = Capacity("", 2, 32, None, 2, reading)
        # A file is read by a process, for up to half a minute.
        self.imports = Capacity("file of requirements is being read", 1, 4, 60.0, 10)
        # A password takes 19 MiB and tenths of a second of a core.
        signing_in = "many users are signing in at the same time: try again in a few seconds"
        self.passwords = Capacity("", 2, 16, None, 2, signing_in)
