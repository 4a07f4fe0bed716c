"""Processes only the newest request of each client: older pending ones are refused."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import TypeVar

from backend.http.capacity import Capacity, Gone
from backend.http.errors import RefusedError

Result = TypeVar("Result")

OVERTAKEN = "superseded by a newer request of this client: use the newer answer"
GONE = "the client closed the connection before the answer"


@dataclass(eq=False)
class Turn:
    order: int
    """Increases with every request."""
    begun: bool = False
    """Whether its work has started in a thread, which cannot be cancelled."""
    overtaken: asyncio.Event = field(default_factory=asyncio.Event)


class Turns:
    """The newest pending request of every client; used on one event loop."""

    def __init__(self) -> None:
        self._newest: dict[Hashable, Turn] = {}
        self._order = itertools.count(1)
        self._begun: set[asyncio.Task[object]] = set()

    async def run(
        self, account: str, client: Hashable, capacity: Capacity, work: Callable[[Turn], Result], gone: Gone
    ) -> Result:
        """Run the work in the capacity's threads; raises `RefusedError` 409 once it is superseded.

        account: as in `Capacity.turn`.
        """
        turn = Turn(next(self._order))
        if (older := self._newest.get(client)) is not None:
            older.overtaken.set()
        self._newest[client] = turn
        job = asyncio.create_task(self._work(account, turn, capacity, work, gone))
        overtaken = asyncio.create_task(turn.overtaken.wait())
        try:
            await asyncio.wait((job, overtaken), return_when=asyncio.FIRST_COMPLETED)
            if turn.overtaken.is_set():
                raise RefusedError("flight-overtaken", OVERTAKEN)
            return job.result()
        finally:
            overtaken.cancel()
            self._leave(job, turn)
            if self._newest.get(client) is turn:
                del self._newest[client]

    def _leave(self, job: asyncio.Task[Result], turn: Turn) -> None:
        """Remove a job from the queue if it has not started; otherwise it keeps its slot until its thread is done."""
        if not turn.begun:
            job.cancel()
        elif not job.done():
            self._begun.add(job)
            job.add_done_callback(self._forget)
        elif not job.cancelled():
            job.exception()  # retrieve the exception, also if the request was superseded at the same time

    def _forget(self, job: asyncio.Task[Result]) -> None:
        self._begun.discard(job)
        if not job.cancelled():
            job.exception()

    @staticmethod
    async def _work(account: str, turn: Turn, capacity: Capacity, work: Callable[[Turn], Result], gone: Gone) -> Result:
        async with capacity.turn(account):
            if await gone():
                raise RefusedError("busy", GONE)
            turn.begun = True
            return await capacity.thread(lambda: work(turn))
