"""Annotations of a submitted run (name, tags, notes, pin), and cancelling several runs."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import sqlalchemy as sa

from backend.access.own import require_own
from backend.db import audit, queue
from backend.db.access import Visitor
from backend.db.tables import Run
from backend.http.errors import RefusedError, existing, not_found
from backend.http.matches import require_match, tag
from backend.runs import listing
from backend.runs.removal import refuse_removed
from backend.runs.requests import RunEdit
from backend.runs.schemas import RunSummary
from backend.runs.tombstones import refuse_purged
from campaigns import Problem
from campaigns.runs import run_name


def etag(reader: sa.Connection, run_id: int) -> str:
    """The entity tag of what users edit; 404 if there is no such run."""
    columns = (Run.name, Run.tags, Run.notes, Run.pinned, Run.removed)
    row = reader.execute(sa.select(*columns).where(Run.id == run_id)).one_or_none()
    return tag(*existing(row, "run", run_name(run_id)))


def edit(engine: sa.Engine, run_id: int, changes: RunEdit, visitor: Visitor, match: str | None = None) -> None:
    """Change the given fields. 404 if there is no such run, 403 if it is another user's, 422 if no field is given, 409
    if the notes have changed or the run is removed, 412 if `match` (If-Match) is not its tag.
    """
    values = changes.model_dump(exclude_unset=True, exclude={"notes_before"})
    empty = [key for key, value in values.items() if value is None]
    if empty or not values:
        message = "give at least one of name, tags, notes and pinned; omitted fields stay unchanged"
        raise RefusedError("invalid", message, [Problem(key, "null", message) for key in empty])
    if changes.tags is not None:
        values["tags"] = list(dict.fromkeys(changes.tags))
    with engine.begin() as writer:
        refuse_removed(writer, run_id)
        owner = writer.scalar(sa.select(Run.owner).where(Run.id == run_id))
        require_own(visitor, owner, run_name(run_id))
        if match is not None:
            require_match(match, etag(writer, run_id), run_name(run_id))
        if changes.notes is not None and changes.notes_before is not None:
            _unchanged(writer, run_id, changes.notes_before, changes.notes)
        if writer.execute(sa.update(Run).where(Run.id == run_id).values(**values)).rowcount != 1:
            raise not_found("run", run_name(run_id))
        audit.note(writer, visitor, "run.edited", run_name(run_id), _audited(values))


def _unchanged(writer: sa.Connection, run_id: int, before: str, after: str) -> None:
    """Raise 409 unless the notes are as they were read, or as they are to be: the edit is repeated."""
    stored = writer.scalar(sa.select(Run.notes).where(Run.id == run_id).with_for_update())
    if stored is not None and stored not in (before, after):
        detail = "these notes were changed since they were read: read them again, then add your text"
        raise RefusedError("notes-changed", detail)


def _audited(values: dict[str, object]) -> dict[str, object]:
    """The entry of the audit trail; notes, which can be long, are stored as length and digest."""
    notes = values.get("notes")
    if not isinstance(notes, str):
        return values
    digest = hashlib.sha256(notes.encode()).hexdigest()
    return values | {"notes": {"characters": len(notes), "sha256": digest}}


def cancel(engine: sa.Engine, run_ids: Sequence[int], visitor: Visitor) -> list[RunSummary]:
    """Cancel several runs; those that have ended are unchanged.

    404 if one does not exist, 403 if one is another user's; then none is cancelled.
    """
    with engine.begin() as writer:
        owners = dict(writer.execute(sa.select(Run.id, Run.owner).where(Run.id.in_(run_ids))).all())
        for run_id in run_ids:
            if run_id not in owners:
                raise not_found("run", run_name(run_id))
            require_own(visitor, owners[run_id], run_name(run_id))
            refuse_purged(writer, run_id)
        cancelled(writer, run_ids, visitor)
    return listing.named(engine, run_ids)


def cancelled(writer: sa.Connection, run_ids: Sequence[int], visitor: Visitor, **detail: object) -> None:
    """Cancel these runs; the audit trail has those that this changed. detail: what their entries have besides."""
    changed = []
    for run_id in sorted(set(run_ids)):  # the runs in one order and then the trail, as every request takes them
        before = writer.scalar(sa.select(Run.state).where(Run.id == run_id).with_for_update())
        state = queue.request_cancel(writer, run_id)
        if state != before:
            changed.append((run_id, state))
    for run_id, state in changed:
        audit.note(writer, visitor, "run.cancelled", run_name(run_id), {"state": state, **detail})
