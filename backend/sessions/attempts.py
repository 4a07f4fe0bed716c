"""Limits the cost of wrong login codes: they cause no writes, and above a rate no individual reads.

A valid code is accepted at any rate, at the latest one second after its creation: wrong codes of others cannot prevent
a user from signing in.
"""

from __future__ import annotations

import time

from backend.access.door import Door
from backend.db import access

BURST = 20
"""Burst of wrong codes answered with 403; further ones are answered with 429."""

PERIOD = 3.0
"""Interval after which one more is allowed [s]."""

RECENT = 1.0
"""Above the rate, the valid codes are read at this interval [s]."""


class Attempts:
    """Counts wrong codes in memory; used on one event loop."""

    def __init__(self, door: Door) -> None:
        self._door = door
        self._wrong, self._since = 0.0, time.monotonic()
        self._good: frozenset[str] = frozenset()
        self._looked = -RECENT

    @property
    def over(self) -> bool:
        return self._wrong >= BURST

    async def good(self, code: str) -> bool:
        """Whether this code may open a session; a wrong one is counted."""
        at = time.monotonic()
        self._wrong, self._since = max(0.0, self._wrong - (at - self._since) / PERIOD), at
        few = not self.over
        # counted before the check, because many requests may arrive at the same time
        self._wrong = min(self._wrong + 1, BURST + 1)
        if few or at - self._looked >= RECENT:
            self._looked = at
            self._good = await self._door.ask(access.valid_codes)
        good = access.hashed(code) in self._good
        if good:
            self._wrong = max(0.0, self._wrong - 1)
        return good
