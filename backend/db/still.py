"""The runs that stand still: a worker has them, and they have stored no evaluation for minutes."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import Run
from campaigns.runs import HELD

STILL = 600.0
"""A run that stored no evaluation for this long stands still [s]."""


def standing_still(reader: sa.Connection) -> dict[int, float]:
    """Their numbers, with the time of the last evaluation, or since when a worker has them [s since 1970].

    Nothing is known of a run whose worker is of a version that does not store it.
    """
    still = sa.select(Run.id, Run.advanced).where(Run.state.in_(HELD), Run.advanced < now(reader) - STILL)
    return {row.id: row.advanced for row in reader.execute(still.order_by(Run.id))}
