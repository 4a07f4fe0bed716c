"""Reads the audit trail in pages and as JSON lines."""

from __future__ import annotations

import json
from collections.abc import Iterator

import sqlalchemy as sa

from backend.db import audit
from backend.db.access import Visitor
from backend.db.tables import Audit, Token
from backend.http.errors import foreign_cursor
from backend.trail.schemas import AuditEntry, AuditPage

MOST_ACTORS = 500


def page(reader: sa.Connection, actor: str, action: str, cursor: str | None, limit: int) -> AuditPage:
    """A page, newest first. actor: also the actions of that user's tokens. action: or a family, such as `run`."""
    filters = []
    if actor:
        owned = sa.select(Token.name).where(Token.owner == actor)
        filters.append(sa.or_(Audit.user == actor, Audit.user.in_(owned)))
    if action:
        filters.append(
            Audit.action == action if "." in action else Audit.action.startswith(f"{action}.", autoescape=True)
        )
    if cursor is not None:
        filters.append(Audit.id < _number(cursor))
    of = sa.select(*audit.COLUMNS, audit.ACCOUNT).where(*filters).order_by(Audit.id.desc()).limit(limit + 1)
    found = reader.execute(of).mappings().all()
    items = [_entry(audit.as_row(row)) for row in found[:limit]]
    more = len(found) > limit
    return AuditPage(
        items=items,
        next_cursor=str(items[-1].id) if more else None,
        head=str(audit.head(reader)),
        total=reader.scalar(sa.select(sa.func.count()).select_from(Audit)) or 0,
        actions=list(reader.scalars(sa.select(Audit.action).distinct().order_by(Audit.action))),
        actors=list(reader.scalars(sa.select(Audit.user).distinct().order_by(Audit.user).limit(MOST_ACTORS))),
    )


def export(engine: sa.Engine, visitor: Visitor) -> Iterator[str]:
    """All rows as JSON lines, oldest first; the export itself is recorded, as the last of them."""
    with engine.begin() as writer:
        audit.note(writer, visitor, "audit.exported", "audit", {"rows": audit.head(writer).row})
        until = audit.head(writer).row
    rows = audit.all_rows(engine, until)
    return (json.dumps(row, sort_keys=True, separators=(",", ":"), allow_nan=False) + "\n" for row in rows)


def _entry(row: audit.Row) -> AuditEntry:
    """A row; a detail that is not an object was changed, and is shown as it is."""
    detail = row["detail"] if isinstance(row["detail"], dict) else {"unreadable": str(row["detail"])}
    return AuditEntry.model_validate({**row, "detail": detail})


def _number(cursor: str) -> int:
    if not cursor.isascii() or not cursor.isdigit() or len(cursor) > 18:
        raise foreign_cursor(cursor)
    return int(cursor)
