"""GET and POST /drafts; GET, PUT and DELETE of one draft. A save must be based on the newest version."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Query, Response, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.access.own import require_own
from backend.db import audit, users
from backend.db.access import Visitor
from backend.db.engine import now
from backend.db.tables import Draft as Row
from backend.db.tables import Run
from backend.drafts.schemas import Draft, DraftContent, DraftReplace, DraftSummary
from backend.http.deps import Engine, Reader
from backend.http.errors import RefusedError, not_found, problems
from backend.http.matches import TAGGED, IfMatch, require_match
from backend.http.schema import DraftName, Number32
from backend.runs.service import number
from campaigns.runs import run_name

router = APIRouter(tags=["drafts"])

MOST, MOST_EACH = 1000, 200
"""Maximum number of drafts, in total and of a user: a program that creates one per save neither fills the disk nor
takes the drafts of others."""

_ID = re.compile(r"D-([0-9]{1,9})")
_LISTED = [getattr(Row, name) for name in ("id", "version", "name", "tags", "owner", "created", "saved", "saved_by")]


@router.get("/drafts")
def list_drafts(reader: Reader) -> list[DraftSummary]:
    """The drafts of all users, the last saved first."""
    query = sa.select(*_LISTED, Row.run_id).order_by(Row.saved.desc(), Row.id.desc())
    return [DraftSummary.model_validate(_draft(row)) for row in reader.execute(query).mappings()]


@router.post("/drafts", status_code=status.HTTP_201_CREATED, responses=problems("too-many-drafts", *ONCE))
def create_draft(content: DraftContent, once: OnceOnly, visitor: CurrentVisitor) -> Draft:
    """Store a new draft of a campaign with its original text."""
    return once.do(Draft, lambda writer: _created(writer, content, visitor), lambda draft: draft.id)


@router.get("/drafts/{draft}", responses=TAGGED | problems("not-found"))
def get_draft(draft: DraftName, response: Response, reader: Reader) -> Draft:
    """A draft with its text."""
    found = _one(reader, _number(draft))
    response.headers["ETag"] = _etag(found)
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
    draft_id = _number(draft)
    values: dict[str, object] = content.model_dump(exclude={"version", "run"})
    with engine.begin() as writer:
        owner = writer.scalar(sa.select(Row.owner).where(Row.id == draft_id).with_for_update())
        require_own(visitor, owner, _name(draft_id))
        if match is not None:
            require_match(match, _etag(_one(writer, draft_id)), _name(draft_id))
        if content.run is not None:
            values["run_id"] = _run(writer, content.run)
        values |= {"version": content.version + 1, "saved": now(writer), "saved_by": visitor.user}
        same = (Row.id == draft_id, Row.version == content.version)
        written = writer.execute(sa.update(Row).where(*same).values(**values)).rowcount == 1
        stored = _one(writer, draft_id)
        if not written and not _repeats(stored, content, visitor):
            raise _conflict(stored, content.version)
    response.headers["ETag"] = _etag(stored)
    return stored


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
    draft_id = _number(draft)
    with engine.begin() as writer:
        writer.execute(sa.select(Row.id).where(Row.id == draft_id).with_for_update())
        stored = _one(writer, draft_id)
        require_own(visitor, stored.owner, stored.id)
        require_match(match, _etag(stored), stored.id)
        if version is not None and version != stored.version:
            raise _conflict(stored, version)
        writer.execute(sa.delete(Row).where(Row.id == draft_id))
        detail = {"name": stored.name, "owner": stored.owner, "version": stored.version}
        audit.note(writer, visitor, "draft.deleted", stored.id, detail)


def _name(draft_id: int) -> str:
    """The name of a draft: 1 becomes D-0001."""
    return f"D-{draft_id:04d}"


def _number(draft: str) -> int:
    """The number of a draft from its name, D-0001; 404 for anything else."""
    match = _ID.fullmatch(draft)
    if match is None:
        raise not_found("draft", draft)
    return int(match[1])


def _one(reader: sa.Connection, draft_id: int) -> Draft:
    """A draft with its text, or 404."""
    query = sa.select(*_LISTED, Row.run_id, Row.text).where(Row.id == draft_id)
    row = reader.execute(query).mappings().one_or_none()
    if row is None:
        raise not_found("draft", _name(draft_id))
    return Draft.model_validate(_draft(row))


def _created(writer: sa.Connection, content: DraftContent, visitor: Visitor) -> Draft:
    """Store a new draft; 409 if there are too many."""
    users.hold(writer, visitor.account)
    count = sa.select(sa.func.count()).select_from(Row)
    if (writer.scalar(count.where(Row.owner == visitor.account)) or 0) >= MOST_EACH:
        detail = f"you have {MOST_EACH} drafts already, which is the limit: delete some first"
        raise RefusedError("too-many-drafts", detail)
    if (writer.scalar(count) or 0) >= MOST:
        detail = f"there are already {MOST} drafts of all users, which is the limit: delete some first"
        raise RefusedError("too-many-drafts", detail)
    at = now(writer)
    who = {"owner": visitor.account, "saved_by": visitor.user, "created": at, "saved": at}
    values = content.model_dump() | who | {"version": 1}
    draft_id = writer.execute(sa.insert(Row).values(**values).returning(Row.id)).scalar_one()
    return _one(writer, draft_id)


def _etag(draft: Draft) -> str:
    """The entity tag of a draft: every save makes a new version."""
    return f'"{draft.id}-{draft.version}"'


def _run(reader: sa.Connection, run: str) -> int:
    run_id = number(run)
    if reader.scalar(sa.select(Run.id).where(Run.id == run_id)) is None:
        raise not_found("run", run)
    return run_id


def _repeats(stored: Draft, new: DraftReplace, visitor: Visitor) -> bool:
    """Whether the same was saved by this visitor already, and nothing since."""
    content = {**new.model_dump(exclude={"run"}, exclude_none=True), "version": new.version + 1}
    content |= {"saved_by": visitor.user} | ({} if new.run is None else {"run": new.run})
    return all(getattr(stored, name) == value for name, value in content.items())


def _conflict(draft: Draft, version: int) -> RefusedError:
    when = datetime.fromtimestamp(draft.saved, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    detail = (
        f"{draft.id} was saved by {draft.saved_by or 'a user'} at {when} after you opened it (version "
        f"{draft.version}, yours is {version}): open it again, or save yours as a new draft"
    )
    return RefusedError("draft-changed", detail)


def _draft(row: sa.RowMapping) -> dict[str, object]:
    run_id = row["run_id"]
    stored = {key: value for key, value in row.items() if key != "run_id"}
    return stored | {"id": _name(row["id"]), "run": None if run_id is None else run_name(run_id)}
