"""Leases that were not renewed: their workers are gone, whatever the clocks of the machines show."""

from __future__ import annotations

import time

import sqlalchemy as sa

from backend.db.tables import Run
from campaigns.runs import HELD


def doubtful(at: float, longest: float) -> sa.ColumnElement[bool]:
    """Whether the lease of a run has expired, or is further ahead than any is given, as after the clock was put back.

    longest: the longest lease that some worker may give [s].
    """
    return sa.and_(Run.state.in_(HELD), sa.or_(Run.lease_until < at, Run.lease_until > at + longest))


class Leases:
    """The doubtful leases that one worker has seen."""

    def __init__(self) -> None:
        self._seen: dict[tuple[int, int, float], float] = {}
        """By run and fence: when they were first seen [s of the monotonic clock]."""

    def look(self, reader: sa.Connection, at: float, longest: float) -> None:
        before, self._seen = self._seen, {}
        for row in reader.execute(sa.select(Run.id, Run.fence, Run.lease_until).where(doubtful(at, longest))):
            lease = (row.id, row.fence, row.lease_until)
            self._seen[lease] = before.get(lease, time.monotonic())

    def stuck(self, longest: float) -> list[int]:
        """The runs whose doubtful lease was not renewed for the time of a lease: after an outage, its worker may be
        about to renew it."""
        since = time.monotonic() - longest
        return [run for (run, _, _), seen in self._seen.items() if seen <= since]
