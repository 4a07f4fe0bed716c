"""Limits the passwords that are hashed at a time: each takes 19 MiB and tenths of a second of a core."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from anyio import CapacityLimiter, to_thread

from backend.http.errors import RefusedError

Result = TypeVar("Result")

AT_ONCE = 2
WAITING = 16


class Hashing:
    """A small thread pool with a bounded queue; used on one event loop."""

    def __init__(self) -> None:
        self._threads, self.inside = CapacityLimiter(AT_ONCE), 0

    @property
    def full(self) -> RefusedError | None:
        """The refusal if the queue is full."""
        if self.inside < AT_ONCE + WAITING:
            return None
        detail = "many users are signing in at the same time: try again in a few seconds"
        return RefusedError(503, "busy", detail, headers={"Retry-After": "2"})

    async def run(self, work: Callable[[], Result]) -> Result:
        """The result of `work`; raises 503 if the queue is full."""
        if self.full is not None:
            raise self.full
        self.inside += 1
        try:
            return await to_thread.run_sync(work, limiter=self._threads)
        finally:
            self.inside -= 1
