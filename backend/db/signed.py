"""Who signed a sign-off; and migrations that store the same results in another form rebind sign-offs to them.

A sign-off is rebound only if the results were those that had been signed; each change is recorded in the audit trail.
"""

from __future__ import annotations

from typing import NamedTuple

import sqlalchemy as sa

from backend.db import audit
from backend.db.roles import LOCAL
from backend.db.tables import Signoff
from campaigns.runs import run_name


class Signer(NamedTuple):
    """The account, or without accounts the name as typed."""

    name: str
    typed: bool


def signer(account: str, name: str) -> Signer:
    """name: as typed. `local` is the account of everyone who has the login link, so what was typed tells them apart."""
    typed = account == LOCAL and name != ""
    return Signer(name if typed else account, typed)


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
