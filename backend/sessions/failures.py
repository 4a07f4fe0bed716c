"""Wrong login links and invitations in the audit trail: a bounded number of rows, each with the number of attempts.

They come from unauthenticated clients: neither may they fill the disk, nor wait for other writers. The
codes are not recorded.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import sqlalchemy as sa

from backend.access.door import Door
from backend.access.rates import Bucket
from backend.db import audit

BURST = 10
"""Rows that are written at once."""

PERIOD = 600.0
"""Interval after which one more is written [s]: at most 154 rows in a day."""

UNKNOWN = "unknown"
"""The user in the trail of an attempt to sign in that names none."""

LINK = "session.link_failed"
INVITATION = "user.invitation_failed"


class Failures:
    """Counts wrong codes, and records them; used on one event loop."""

    def __init__(self, door: Door) -> None:
        self._door, self._rows = door, Bucket(BURST, PERIOD)
        self._counts: Counter[str] = Counter()
        self._address = ""

    def wrong(self, action: str, address: str) -> None:
        """Count an attempt; recorded now, or together with a later one."""
        self._counts[action] += 1
        self._address = address
        if not self._rows.wait():
            self._door.later(*self._due())

    async def flush(self) -> None:
        """Record what was counted but not recorded, when the service stops."""
        if self._counts:
            await self._door.write(*self._due())
        await self._door.written()

    def _due(self) -> tuple[Callable[[sa.Connection], None], Callable[[], None]]:
        """What to write, and what to do if that fails: count the attempts again."""
        counts, address, self._counts = self._counts, self._address, Counter()

        def write(writer: sa.Connection) -> None:
            for action, attempts in sorted(counts.items()):
                detail: dict[str, object] = {"address": address[:64], "attempts": attempts}
                audit.note_sign_in(writer, UNKNOWN, "link", action, detail)

        return write, lambda: self._counts.update(counts)
