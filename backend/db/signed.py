"""Sign-offs through migrations: a migration that writes the same results in another shape binds their sign-offs again.

Only where the results were those that had been signed; each is noted in the audit trail. Start reading at `bind_again`.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import audit
from backend.db.digest import results_digest
from backend.db.tables import Signoff
from campaigns.runs import run_name


def is_signed(reader: sa.Connection, run_id: int) -> bool:
    """Whether a sign-off was ever given of it."""
    return reader.scalar(sa.select(Signoff.id).where(Signoff.run_id == run_id).limit(1)) is not None


def digest(reader: sa.Connection, run_id: int) -> str:
    """As sign-offs are bound to it now. A change to it needs a migration that binds them again."""
    return results_digest(reader, run_id)


def digest_of_0010(reader: sa.Connection, run_id: int) -> str:
    """As it was up to revision 0010: of a finding without slices, boundary and closest approach."""
    return results_digest(reader, run_id, evidence=False)


def bind_again(writer: sa.Connection, run_id: int, before: str, after: str, by: str) -> None:
    """Binds the sign-offs of a run's results, whose digest was `before`, to the digest that they have now."""
    if before == after:
        return
    mine = (Signoff.run_id == run_id, Signoff.digest == before)
    for signoff_id in writer.scalars(sa.select(Signoff.id).where(*mine)).all():
        writer.execute(sa.update(Signoff).where(Signoff.id == signoff_id).values(digest=after))
        detail = {"signoff": signoff_id, "before": before, "after": after}
        audit.note_command(writer, by, "signoff.bound", run_name(run_id), detail)
