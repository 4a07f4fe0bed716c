"""The runs that stand still: a worker has them, and they have stored no evaluation for minutes."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import Run
from campaigns.runs import HELD

STILL = 600.0
"""A run that stored no evaluation for this long stands still [s]."""


def standing_still(reader: sa.Connection) -> dict[int, float]:
    """Their numbers, with the time of the last evaluation [s since 1970].

    One begun before that was stored counts from its start, which may be too early by the time that it waited.
    """
    since = sa.func.coalesce(Run.advanced, Run.started)
    still = sa.select(Run.id, since.label("since")).where(Run.state.in_(HELD), since < now(reader) - STILL)
    return {row.id: row.since for row in reader.execute(still.order_by(Run.id))}
