"""The registry of open viewers: their number, and which of them a page may control.

Used only on the event loop.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import Counter
from dataclasses import dataclass

from anyio import CapacityLimiter

from backend.db.access import Visitor
from backend.scenes.viewer.viewer import Viewer

THREADS = 8


@dataclass(frozen=True)
class Handle:
    """Identifies a viewer: a page's key is valid only for its visitor and run."""

    visitor: Visitor
    run_id: int
    key: str


class Viewers:
    def __init__(self, most: int, most_each: int) -> None:
        """most, most_each: maximum number of open viewers, in total and of a user."""
        self.open, self.most, self.most_each = 0, most, most_each
        self.threads = CapacityLimiter(THREADS)
        """The threads that create and close viewers."""
        self._of: Counter[str] = Counter()
        self.stopping = asyncio.Event()
        """Set when all viewers must end."""
        self.steered: dict[Handle, Viewer] = {}
        self._changed = asyncio.Event()

    def enter(self, visitor: Visitor) -> bool:
        """Reserve a viewer for this visitor; false if a limit is reached."""
        if self.full(visitor):
            return False
        self.open += 1
        self._of[visitor.account] += 1
        return True

    def leave(self, visitor: Visitor) -> None:
        self.open -= 1
        self._of[visitor.account] -= 1
        if not self._of[visitor.account]:
            del self._of[visitor.account]

    def full(self, visitor: Visitor) -> str:
        """The limit that is reached for this visitor; empty if there is none."""
        if self.open >= self.most:
            return f"{self.most} 3D views are open, which is the limit"
        if self._of[visitor.account] >= self.most_each:
            return f"{self.most_each} 3D views of your sessions and tokens are open, which is the limit"
        return ""

    def stop(self) -> None:
        self.most = 0
        self.stopping.set()
        self._tell()

    def offer(self, handle: Handle, viewer: Viewer) -> None:
        """Register a viewer under its key; replaces an older one with the same key."""
        self.steered[handle] = viewer
        loop = asyncio.get_running_loop()

        def ring() -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended, so there are no waiters
                loop.call_soon_threadsafe(self._tell)

        viewer.on_news = ring
        self._tell()

    def withdraw(self, handle: Handle, viewer: Viewer) -> None:
        """Unregister the viewer; a newer one with the same key stays."""
        if self.steered.get(handle) is viewer:
            del self.steered[handle]
        self._tell()

    async def find(self, handle: Handle, wait: float) -> Viewer | None:
        """The viewer with this key, once it is open, within `wait` [s]; with a `wait`, one that has not failed."""
        deadline = asyncio.get_running_loop().time() + wait
        while not self.stopping.is_set():
            found = self.steered.get(handle)
            if found is not None and not (wait > 0 and found.failed):
                return found
            remaining = deadline - asyncio.get_running_loop().time()
            try:
                await asyncio.wait_for(self._changed.wait(), max(remaining, 0.0))
            except TimeoutError:
                return None
        return self.steered.get(handle)

    async def news(self, handle: Handle, since: int, wait: float) -> Viewer | None:
        """The viewer with this key once it has changed since that revision, at the latest after `wait` [s].

        None as soon as it is closed.
        """
        deadline = asyncio.get_running_loop().time() + wait
        while True:
            changed = self._changed  # before the check, so that no change in between is missed
            viewer = self.steered.get(handle)
            remaining = deadline - asyncio.get_running_loop().time()
            known = viewer is not None and viewer.revision == since and not viewer.failed
            if not known or remaining <= 0 or self.stopping.is_set():
                return viewer
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(changed.wait(), remaining)

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()
