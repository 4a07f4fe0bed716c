"""Rebinds sign-offs in migrations that store the same results in another form.

A sign-off is rebound only if the results were those that had been signed; each change is recorded in the audit trail.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import audit
from backend.db.tables import Signoff
from campaigns.runs import run_name


def is_signed(reader: sa.Connection, run_id: int) -> bool:
    return reader.scalar(sa.select(Signoff.id).where(Signoff.run_id == run_id).limit(1)) is not None


def bind_again(writer: sa.Connection, run_id: int, before: str, after: str, by: str) -> None:
    """Rebind the sign-offs of a run's results from the digest `before` to the digest `after`."""
    if before == after:
        return
    mine = (Signoff.run_id == run_id, Signoff.digest == before)
    for signoff_id in writer.scalars(sa.select(Signoff.id).where(*mine)).all():
        writer.execute(sa.update(Signoff).where(Signoff.id == signoff_id).values(digest=after))
        detail = {"signoff": signoff_id, "before": before, "after": after}
        chained = sa.inspect(writer).has_table("audit_head")
        note = audit.note_command if chained else audit.note_unchained
        note(writer, by, "signoff.bound", run_name(run_id), detail)
