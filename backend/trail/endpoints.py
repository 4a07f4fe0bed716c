"""GET /audit and /audit/export."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse

from backend.access.auth import CurrentVisitor
from backend.db import audit
from backend.db.tables import Audit, Token
from backend.http.deps import Engine, Reader
from backend.http.errors import RefusedError, answers, problems
from backend.trail.schemas import AuditEntry, AuditPage

router = APIRouter(tags=["audit"])

MOST_ACTORS = 500

LINES = answers(
    "One JSON object a line, oldest first; `clearance trail verify --file` verifies it.", "application/jsonl"
)


@router.get("/audit", responses=problems("bad-cursor"))
def list_audit(
    reader: Reader,
    actor: Annotated[str, Query(max_length=64, description="A user, with their tokens, or a token.")] = "",
    action: Annotated[str, Query(max_length=40, description="An action, or the part before its dot.")] = "",
    cursor: Annotated[str | None, Query(max_length=40, description="`next_cursor` of the previous page.")] = None,
    limit: Annotated[int, Query(ge=1, le=500, description="Maximum number of rows on a page.")] = 100,
) -> AuditPage:
    """The audit trail in pages, newest first."""
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


@router.get("/audit/export", response_class=StreamingResponse, responses=LINES)
def export_audit(engine: Engine, visitor: CurrentVisitor) -> StreamingResponse:
    """The whole audit trail as JSON lines, oldest first; the export is recorded, as its last row."""
    with engine.begin() as writer:
        audit.note(writer, visitor, "audit.exported", "audit", {"rows": audit.head(writer).row})
        until = audit.head(writer).row
    headers = {"Content-Disposition": 'attachment; filename="clearance-audit.jsonl"'}
    return StreamingResponse(_lines(engine, until), headers=headers, media_type="application/jsonl")


def _lines(engine: sa.Engine, until: int) -> Iterator[str]:
    for row in audit.all_rows(engine, until):
        yield json.dumps(row, sort_keys=True, separators=(",", ":"), allow_nan=False) + "\n"


def _entry(row: audit.Row) -> AuditEntry:
    """A row; a detail that is not an object was changed, and is shown as it is."""
    detail = row["detail"] if isinstance(row["detail"], dict) else {"unreadable": str(row["detail"])}
    return AuditEntry.model_validate({**row, "detail": detail})


def _number(cursor: str) -> int:
    if not cursor.isascii() or not cursor.isdigit() or len(cursor) > 18:
        raise RefusedError("bad-cursor", f"the cursor {cursor[:40]!r} is not one of this list: begin without one")
    return int(cursor)
