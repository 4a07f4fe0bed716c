"""GET and POST /drafts; GET, PUT and DELETE of one. Start reading at `save_draft`."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, status

from backend.access.auth import CurrentVisitor
from backend.drafts import service
from backend.drafts.schemas import Draft, DraftContent, DraftReplace, DraftSummary
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.http.schema import DraftName, Number32

router = APIRouter(tags=["drafts"])


@router.get("/drafts")
def list_drafts(reader: Reader) -> list[DraftSummary]:
    """The drafts of everybody, the one saved last first."""
    return service.listed(reader)


@router.post("/drafts", status_code=status.HTTP_201_CREATED, responses=problems("too-many-drafts"))
def create_draft(given: DraftContent, engine: Engine, visitor: CurrentVisitor) -> Draft:
    """Keep a campaign that is being prepared, as it was typed."""
    return service.create(engine, given, visitor)


@router.get("/drafts/{draft}", responses=problems("not-found"))
def get_draft(draft: DraftName, reader: Reader) -> Draft:
    """A draft with its text."""
    return service.one(reader, service.number(draft))


@router.put("/drafts/{draft}", responses=problems("not-found", "draft-changed"))
def save_draft(draft: DraftName, given: DraftReplace, engine: Engine, visitor: CurrentVisitor) -> Draft:
    """Save a draft over the version that was opened; 409 where somebody saved it meanwhile."""
    return service.replace(engine, service.number(draft), given, visitor)


@router.delete(
    "/drafts/{draft}", status_code=status.HTTP_204_NO_CONTENT, responses=problems("not-found", "draft-changed")
)
def delete_draft(
    draft: DraftName,
    engine: Engine,
    visitor: CurrentVisitor,
    version: Annotated[Number32 | None, Query(description="Delete it only where this is the newest.")] = None,
) -> None:
    """Delete a draft, whoever made it; the audit trail keeps that."""
    service.delete(engine, service.number(draft), version, visitor)
