"""Drafts: stored as original text; a save must be based on the newest version."""

from __future__ import annotations

import re
from datetime import UTC, datetime

import sqlalchemy as sa

from backend.access.own import require_own
from backend.db import audit, users
from backend.db.access import Visitor
from backend.db.engine import now
from backend.db.tables import Draft as Row
from backend.db.tables import Run
from backend.drafts.schemas import Draft, DraftContent, DraftReplace, DraftSummary
from backend.http.errors import RefusedError, existing
from backend.http.matches import require_match
from backend.runs import service
from campaigns.runs import run_name

MOST, MOST_EACH = 1000, 200
"""Maximum number of drafts, in total and of a user: a program that creates one per save neither fills the disk nor
takes the drafts of others."""

_ID = re.compile(r"D-([0-9]{1,9})")
_LISTED = [getattr(Row, name) for name in ("id", "version", "name", "tags", "owner", "created", "saved", "saved_by")]


def name(draft_id: int) -> str:
    """The name of a draft: 1 becomes D-0001."""
    return f"D-{draft_id:04d}"


def number(draft: str) -> int:
    """The number of a draft from its name, D-0001; 404 for anything else."""
    return int(existing(_ID.fullmatch(draft), "draft", draft)[1])


def listed(reader: sa.Connection) -> list[DraftSummary]:
    """All drafts without their texts, the last saved first."""
    query = sa.select(*_LISTED, Row.run_id).order_by(Row.saved.desc(), Row.id.desc())
    return [DraftSummary.model_validate(_draft(row)) for row in reader.execute(query).mappings()]


def one(reader: sa.Connection, draft_id: int) -> Draft:
    """A draft with its text, or 404."""
    query = sa.select(*_LISTED, Row.run_id, Row.text).where(Row.id == draft_id)
    row = existing(reader.execute(query).mappings().one_or_none(), "draft", name(draft_id))
    return Draft.model_validate(_draft(row))


def create(writer: sa.Connection, content: DraftContent, visitor: Visitor) -> Draft:
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
    return one(writer, draft_id)


def etag(draft: Draft) -> str:
    """The entity tag of a draft: every save makes a new version."""
    return f'"{draft.id}-{draft.version}"'


def replace(engine: sa.Engine, draft_id: int, new: DraftReplace, visitor: Visitor, match: str | None = None) -> Draft:
    """Save a draft over the named version.

    404 if there is no such draft, 403 if it is another user's, 409 if another version was saved since, 412 if `match`
    (If-Match) is not its tag.
    """
    values: dict[str, object] = new.model_dump(exclude={"version", "run"})
    with engine.begin() as writer:
        owner = writer.scalar(sa.select(Row.owner).where(Row.id == draft_id).with_for_update())
        require_own(visitor, owner, name(draft_id))
        if match is not None:
            require_match(match, etag(one(writer, draft_id)), name(draft_id))
        if new.run is not None:
            of = sa.select(Run.id).where(Run.id == service.number(new.run))
            values["run_id"] = existing(writer.scalar(of), "run", new.run)
        values |= {"version": new.version + 1, "saved": now(writer), "saved_by": visitor.user}
        same = (Row.id == draft_id, Row.version == new.version)
        written = writer.execute(sa.update(Row).where(*same).values(**values)).rowcount == 1
        stored = one(writer, draft_id)
        if not written and not _repeats(stored, new, visitor):
            raise _conflict(stored, new.version)
        return stored


def delete(engine: sa.Engine, draft_id: int, version: int | None, visitor: Visitor, match: str | None = None) -> None:
    """Delete a draft; raises as `replace` does, 409 if `version` is not the newest."""
    with engine.begin() as writer:
        writer.execute(sa.select(Row.id).where(Row.id == draft_id).with_for_update())
        draft = one(writer, draft_id)
        require_own(visitor, draft.owner, draft.id)
        require_match(match, etag(draft), draft.id)
        if version is not None and version != draft.version:
            raise _conflict(draft, version)
        writer.execute(sa.delete(Row).where(Row.id == draft_id))
        detail = {"name": draft.name, "owner": draft.owner, "version": draft.version}
        audit.note(writer, visitor, "draft.deleted", draft.id, detail)


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
    return stored | {"id": name(row["id"]), "run": None if run_id is None else run_name(run_id)}
