"""GET and POST /drafts; GET, PUT and DELETE of one draft."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.drafts import service
from backend.drafts.schemas import Draft, DraftContent, DraftReplace, DraftSummary
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.http.matches import TAGGED, IfMatch
from backend.http.schema import DraftName, Number32

router = APIRouter(tags=["drafts"])


@router.get("/drafts")
def list_drafts(reader: Reader) -> list[DraftSummary]:
    """The drafts of all users, the last saved first."""
    return service.listed(reader)


@router.post(
    "/drafts",
    status_code=status.HTTP_201_CREATED,
    responses=problems("too-many-drafts", *ONCE),
)
def create_draft(content: DraftContent, once: OnceOnly, visitor: CurrentVisitor) -> Draft:
    """Store a new draft of a campaign with its original text."""
    return once.do(Draft, lambda writer: service.create(writer, content, visitor), lambda draft: draft.id)


@router.get("/drafts/{draft}", responses=TAGGED | problems("not-found"))
def get_draft(draft: DraftName, response: Response, reader: Reader) -> Draft:
    """A draft with its text."""
    found = service.one(reader, service.number(draft))
    response.headers["ETag"] = service.etag(found)
    return found


@router.put("/drafts/{draft}", responses=TAGGED | problems("not-found", "draft-changed", "changed"))
def save_draft(
    draft: DraftName,
    content: DraftReplace,
    response: Response,
    engine: Engine,
    visitor: CurrentVisitor,
    match: IfMatch = None,
) -> Draft:
    """Save a draft over the version that was opened; 409 if it was saved since."""
    saved = service.replace(engine, service.number(draft), content, visitor, match)
    response.headers["ETag"] = service.etag(saved)
    return saved


@router.delete(
    "/drafts/{draft}",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=problems("not-found", "draft-changed", "changed"),
)
def delete_draft(
    draft: DraftName,
    engine: Engine,
    visitor: CurrentVisitor,
    version: Annotated[Number32 | None, Query(description="Delete only if this is the newest version.")] = None,
    match: IfMatch = None,
) -> None:
    """Delete a draft; the deletion is recorded in the audit trail."""
    service.delete(engine, service.number(draft), version, visitor, match)
