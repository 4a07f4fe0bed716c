"""Bounds what wrong login codes cost: never a write, and beyond a rate not even a read each.

A good code is accepted whatever the rate, at the latest a second after it was made: wrong codes of others keep nobody
from signing in. Start reading at `Attempts`.
"""

from __future__ import annotations

import time

from backend.access.door import Door
from backend.db import access

BURST = 20
"""So many wrong codes are answered with 403 at once; those beyond with 429."""

PERIOD = 3.0
"""One more is allowed each time [s]."""

RECENT = 1.0
"""Beyond the rate, the codes that are good are looked up this often [s]."""


class Attempts:
    """Counts wrong codes in memory; used on one event loop."""

    def __init__(self, door: Door) -> None:
        self._door = door
        self._wrong, self._since = 0.0, time.monotonic()
        self._good: frozenset[str] = frozenset()
        self._looked = -RECENT

    @property
    def over(self) -> bool:
        """Whether there were too many wrong codes of late."""
        return self._wrong >= BURST

    async def good(self, code: str) -> bool:
        """Whether this code may open a session; a wrong one is counted."""
        at = time.monotonic()
        self._wrong, self._since = max(0.0, self._wrong - (at - self._since) / PERIOD), at
        few = not self.over
        self._wrong = min(self._wrong + 1, BURST + 1)  # until it is known to be good: many may ask at once
        if few or at - self._looked >= RECENT:
            self._looked = at
            self._good = await self._door.ask(access.valid_codes)
        good = access.hashed(code) in self._good
        if good:
            self._wrong = max(0.0, self._wrong - 1)
        return good
