"""Permanently deletes runs that were removed long ago, and reclaims SQLite's disk space.

The row of a purged run stays as a tombstone: its number is never reused, links to it explain what happened, and runs
that extend it still cite it. The audit trail, withdrawn sign-offs and the campaign also stay.
Source on disk space: SQLite, "VACUUM" and "PRAGMA wal_checkpoint".
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa

from backend.db import audit
from backend.db.digest import results_digest
from backend.db.engine import is_sqlite, now, read
from backend.db.tables import (
    EvaluationAhead,
    EvaluationChunk,
    Finding,
    Run,
    RunBaseline,
    RunLabel,
    RunRefusal,
    RunSources,
    RunText,
    Signoff,
    Stage,
    Trace,
)
from campaigns.runs import run_name

_EMPTY: dict[str, object] = {
    "tags": [], "notes": "", "summary": {}, "best_so_far": [], "reason": None, "error": None, "pinned": False,
    "snapshot": None, "size": 0,
}  # fmt: skip


@dataclass(frozen=True)
class Removed:
    """A removed run that is due for purging; `size` is that of its evaluations and traces [bytes]."""

    id: int
    name: str
    removed: float | None
    removed_by: str | None
    removed_reason: str | None
    evaluations: int
    size: int


class Space(NamedTuple):
    before: int
    after: int


def due(engine: sa.Engine, age: float) -> list[Removed]:
    """The runs removed at least `age` [s] ago and not yet purged, the oldest removal first."""
    columns = (Run.id, Run.name, Run.removed, Run.removed_by, Run.removed_reason, Run.evaluations)
    with read(engine) as reader:
        of = sa.select(*columns).where(*_due(now(reader) - age)).order_by(Run.removed, Run.id)
        return [Removed(*row, size=_size(reader, row.id)) for row in reader.execute(of).all()]


def purge(engine: sa.Engine, run_id: int, age: float, user: str) -> bool:
    """Delete a run's results in one transaction; false if it was restored or purged in the meantime."""
    with engine.begin() as writer:
        of = sa.select(Run.id, Run.evaluations).where(Run.id == run_id, *_due(now(writer) - age)).with_for_update()
        row = writer.execute(of).one_or_none()
        if row is None:
            return False
        digest = results_digest(writer, run_id)
        for table in (
            EvaluationAhead,
            EvaluationChunk,
            Stage,
            Finding,
            Trace,
            RunText,
            RunSources,
            RunLabel,
            RunRefusal,
            RunRefusal,
            RunBaseline,
        ):
            writer.execute(sa.delete(table).where(table.run_id == run_id))
        left = {**_EMPTY, "purged": now(writer), "purged_by": user[:64], "purged_digest": digest}
        writer.execute(sa.update(Run).where(Run.id == run_id).values(**left))
        detail = {"results_digest": digest, "evaluations": row.evaluations}
        audit.note_command(writer, user, "run.purged", run_name(run_id), detail)
        return True


def wasted(engine: sa.Engine) -> int:
    """Unused space in an SQLite file [bytes]; 0 on PostgreSQL, which reuses such space automatically."""
    if not is_sqlite(engine):
        return 0
    with read(engine) as reader:
        free, page = (reader.exec_driver_sql(f"PRAGMA {name}").scalar_one() for name in ("freelist_count", "page_size"))
    return int(free) * int(page)


def reclaim(engine: sa.Engine) -> Space:
    """Rewrite an SQLite file without deleted data; temporarily needs the same disk space again.

    Writers are blocked meanwhile. Raises `sqlite3.OperationalError` if the file stays locked or the disk is full.
    """
    file = Path(str(engine.url.database))
    before = file.stat().st_size
    connection = engine.raw_connection()
    try:  # VACUUM must run outside a transaction; other connections of the engine begin one
        connection.cursor().execute("VACUUM")
        connection.cursor().execute("PRAGMA wal_checkpoint(TRUNCATE)")
    finally:
        connection.close()
    return Space(before, file.stat().st_size)


def _due(until: float) -> tuple[sa.ColumnElement[bool], ...]:
    """Removed before `until`; a valid sign-off protects a run from purging in any case."""
    signed = sa.select(Signoff.id).where(Signoff.run_id == Run.id, Signoff.withdrawn.is_(None)).exists()
    return Run.removed.is_not(None), Run.removed <= until, Run.purged.is_(None), ~signed


def _size(reader: sa.Connection, run_id: int) -> int:
    chunk = EvaluationChunk
    columns = (chunk.points, chunk.costs, chunk.status, chunk.seconds)
    evaluations = sa.select(sa.func.sum(sum(sa.func.length(c) for c in columns))).where(chunk.run_id == run_id)
    flights = sa.select(sa.func.sum(sa.func.length(Trace.data))).where(Trace.run_id == run_id)
    return int(reader.scalar(evaluations) or 0) + int(reader.scalar(flights) or 0)
