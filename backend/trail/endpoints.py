"""GET /audit and /audit/export."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse

from backend.access.auth import CurrentVisitor
from backend.http.deps import Engine, Reader
from backend.http.errors import answers, problems
from backend.trail import service
from backend.trail.schemas import AuditPage

router = APIRouter(tags=["audit"])

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
    return service.page(reader, actor, action, cursor, limit)


@router.get("/audit/export", response_class=StreamingResponse, responses=LINES)
def export_audit(engine: Engine, visitor: CurrentVisitor) -> StreamingResponse:
    """The whole audit trail as JSON lines, oldest first; the export is recorded, as its last row."""
    headers = {"Content-Disposition": 'attachment; filename="clearance-audit.jsonl"'}
    return StreamingResponse(service.export(engine, visitor), headers=headers, media_type="application/jsonl")
