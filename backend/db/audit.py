"""The audit trail: who did what to which run, and when. Rows are only added, never changed."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.access import Visitor
from backend.db.engine import now
from backend.db.tables import Audit
from campaigns.documents import JsonObject


def note(writer: sa.Connection, visitor: Visitor, action: str, subject: str, detail: JsonObject) -> None:
    """Record an action in the caller's transaction: `action` such as `signoff.created`, `subject` such as R-0001."""
    _write(writer, action, subject, detail, {"user": visitor.user, "via": visitor.via})


def note_command(writer: sa.Connection, user: str, action: str, subject: str, detail: JsonObject) -> None:
    """Record an action on the command line by an operating-system user."""
    _write(writer, action, subject, detail, {"user": user[:64], "via": "cli"})


def _write(writer: sa.Connection, action: str, subject: str, detail: JsonObject, who: dict[str, str]) -> None:
    writer.execute(sa.insert(Audit).values(at=now(writer), action=action, subject=subject, detail=detail, **who))
