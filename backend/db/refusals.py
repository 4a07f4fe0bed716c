"""Which installations cannot continue a run that other code began: their workers leave it to others.

A run that is refused waits in the queue; nothing of it is lost.
"""

from __future__ import annotations

from collections.abc import Collection

import sqlalchemy as sa

from backend.db.engine import insert, now
from backend.db.outages import storable
from backend.db.tables import Run, RunRefusal

AGAIN = 600.0
"""After which a worker looks at a run again that it has refused [s]: what it lacked may be there."""


def store(writer: sa.Connection, run_id: int, installation: str, text: str) -> None:
    """Record that workers of the installation cannot continue the run; text: what differs, as clauses."""
    changed = {"text": storable(text), "created": now(writer)}
    row = insert(writer, RunRefusal).values(run_id=run_id, installation=installation, **changed)
    writer.execute(row.on_conflict_do_update(index_elements=["run_id", "installation"], set_=changed))


def by(installation: str, at: float) -> sa.ColumnElement[bool]:
    """Whether the installation has refused a run within `AGAIN` before this time; not if that is further ahead, as
    after the clock was put back."""
    here = (RunRefusal.run_id == Run.id, RunRefusal.installation == installation)
    recent = (RunRefusal.created > at - AGAIN, RunRefusal.created <= at + AGAIN)
    return sa.select(RunRefusal.run_id).where(*here, *recent).exists()


def of(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, dict[str, str]]:
    """What differs, by installation, of the refused ones among these runs; the latest refusal last."""
    rows = reader.execute(sa.select(RunRefusal).where(RunRefusal.run_id.in_(run_ids)).order_by(RunRefusal.created))
    found: dict[int, dict[str, str]] = {}
    for row in rows:
        found.setdefault(row.run_id, {})[row.installation] = row.text
    return found


def clear(writer: sa.Connection, run_id: int) -> None:
    writer.execute(sa.delete(RunRefusal).where(RunRefusal.run_id == run_id))
