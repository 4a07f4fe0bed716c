"""Permanently deletes runs that were removed long ago, or the oldest above a size, and reclaims SQLite's disk space.

One rule says what may go, see `_may_go`; by size, runs that were not removed go as well unless something below keeps
them.

The row of a purged run stays as a tombstone: its number is never reused, links to it explain what happened, and runs
that extend it still cite it. The audit trail, withdrawn sign-offs and the campaign also stay.
Source on disk space: SQLite, "VACUUM" and "PRAGMA wal_checkpoint".
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db import audit
from backend.db.digest import results_digest
from backend.db.engine import ask, is_sqlite, now, read
from backend.db.questions import kin
from backend.db.reset import RESULTS
from backend.db.rows import at_or_below, made_again_before, own_question
from backend.db.tables import (
    EvaluationChunk,
    Run,
    RunBaseline,
    RunLabel,
    RunRefusal,
    RunRequirement,
    RunText,
    Signoff,
    Stage,
    Trace,
)
from campaigns.results.verdict import VerdictWord
from campaigns.runs import ACTIVE, ENDED, RunState, run_name


@dataclass(frozen=True)
class Removed:
    """A run that is due for purging; `size` is that of its evaluations and traces [bytes]."""

    id: int
    name: str
    removed: float | None
    """None if it is due by size only."""
    removed_by: str | None
    removed_reason: str | None
    finished: float | None
    evaluations: int
    size: int


@dataclass(frozen=True)
class Beyond:
    """What must go so that no more than a limit is stored."""

    occupied: int
    """What is stored [bytes]."""
    runs: list[Removed]
    left: int
    """What will still be above the limit without them, because the rest may not go [bytes]."""


class Space(NamedTuple):
    before: int
    after: int


_COLUMNS = (Run.id, Run.name, Run.removed, Run.removed_by, Run.removed_reason, Run.finished, Run.evaluations)


def due(engine: sa.Engine, age: float) -> list[Removed]:
    """The runs removed at least `age` [s] ago and not yet purged, the oldest removal first."""
    with engine.begin() as reader:
        _complete(reader)
        of = sa.select(*_COLUMNS).where(*_may_go(now(reader), age)).order_by(Run.removed, Run.id)
        return [Removed(*row, size=_size(reader, row.id)) for row in reader.execute(of).all()]


def beyond(engine: sa.Engine, limit: int, already: Collection[Removed] = ()) -> Beyond:
    """The runs that must go so that at most `limit` is stored [bytes]: removed ones, then those that ended first.

    already: runs that go in any case.
    """
    with engine.begin() as reader:
        _complete(reader)
        stored = occupied(reader)
        left, runs, gone = stored - limit - sum(run.size for run in already), [], {run.id for run in already}
        order = (Run.removed.is_(None), Run.removed, Run.finished, Run.id)
        of = sa.select(*_COLUMNS).where(*_may_go(now(reader), None)).order_by(*order)
        for row in reader.execute(of).all() if left > 0 else ():
            if row.id not in gone and (size := _size(reader, row.id)):
                runs.append(Removed(*row, size=size))
                left -= size
                if left <= 0:
                    break
        return Beyond(stored, runs, max(0, left))


def _complete(writer: sa.Connection) -> None:
    """Store of runs that workers of earlier versions ended what tells whether they speak against a requirement."""
    ended = sa.select(Run.id).where(Run.made_again.is_(None), Run.state.in_(ENDED), Run.purged.is_(None))
    for run_id, value in made_again_before(writer, writer.scalars(ended).all()).items():
        writer.execute(sa.update(Run).where(Run.id == run_id).values(made_again=value))


def exceeded(engine: sa.Engine, limit: int) -> bool:
    """Whether more than that is stored now [bytes]: a run may have had more than its evaluations and traces."""
    return ask(engine, occupied) > limit


def occupied(reader: sa.Connection) -> int:
    """What is stored [bytes]: the used part of an SQLite file; on PostgreSQL, which keeps the space of deleted rows for
    new ones, what quotas count of runs."""
    if is_sqlite(reader):
        pages, free, page = (_pragma(reader, name) for name in ("page_count", "freelist_count", "page_size"))
        return (pages - free) * page
    return int(reader.scalar(sa.select(sa.func.sum(Run.size)).where(Run.purged.is_(None))) or 0)


def purge(engine: sa.Engine, run_id: int, age: float | None, user: str, reason: str = "") -> bool:
    """Delete a run's results in one transaction; false if it may not go any more, as when it was restored or signed.

    age: None if it is due by size, for the reason given, which a run that was not removed then has.
    """
    with engine.begin() as writer:
        at = now(writer)
        # Locked first: PostgreSQL would not look again at what was signed while this waited for the lock.
        writer.execute(sa.select(Run.id).where(Run.id == run_id).with_for_update())
        of = sa.select(Run.evaluations, Run.removed, Run.worst_cost, Run.made_again)
        of = of.where(Run.id == run_id, *_may_go(at, age))
        row = writer.execute(of).one_or_none()
        if row is None:
            return False
        digest = results_digest(writer, run_id)
        lowest = _lowest(writer, run_id, row.worst_cost, row.made_again)
        for table in (*RESULTS, RunText, RunLabel, RunRefusal, RunBaseline):
            writer.execute(sa.delete(table).where(table.run_id == run_id))
        update = sa.update(Run).where(Run.id == run_id)
        update = update.values(purged=at, purged_by=user[:64], purged_digest=digest, worst_cost=lowest)
        update = update.values(tags=[], notes="", summary={}, best_so_far=[], reason=None, error=None, pinned=False)
        update = update.values(snapshot=None, size=0)
        if row.removed is None:
            update = update.values(removed=at, removed_by=user[:64], removed_reason=reason)
        writer.execute(update)
        if row.removed is None:
            audit.note_command(writer, user, "run.removed", run_name(run_id), {"reason": reason})
        detail = {"results_digest": digest, "evaluations": row.evaluations}
        audit.note_command(writer, user, "run.purged", run_name(run_id), detail)
        return True


def _lowest(reader: sa.Connection, run_id: int, *known: float | None) -> float | None:
    """The lowest value of a run: that it found a violation outlives its stages, which have what no search found."""
    of = sa.select(sa.func.min(Stage.best)).where(Stage.run_id == run_id, own_question())
    return min((cost for cost in (*known, reader.scalar(of)) if cost is not None), default=None)


class Unused(NamedTuple):
    """The space in an SQLite file that holds nothing [bytes], and as a share; in_flight: whether a run is executed."""

    size: int
    share: float
    in_flight: bool


def unused(engine: sa.Engine) -> Unused:
    """What rewriting the file would free, and whether it would stop a run's worker from storing."""
    with read(engine) as reader:
        pages = _pragma(reader, "freelist_count")
        in_flight = reader.scalar(sa.select(Run.id).where(Run.state == RunState.RUNNING).limit(1)) is not None
        return Unused(pages * _pragma(reader, "page_size"), pages / _pragma(reader, "page_count"), in_flight)


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


def _may_go(at: float, age: float | None) -> tuple[sa.ColumnElement[bool], ...]:
    """Ended, not yet purged, without a valid sign-off, and no run that continues it may still need its evaluations.

    By age [s]: removed so long before `at`. Without one: removed, or not kept by a rule.
    """
    signed = sa.select(Signoff.id).where(Signoff.run_id == Run.id, Signoff.withdrawn.is_(None)).exists()
    other = orm.aliased(Run)
    again = sa.and_(other.state == RunState.FAILED, other.removed.is_(None))  # it may be tried again
    waits = sa.or_(other.state.in_(ACTIVE), again)
    carried = sa.select(other.id).where(other.continues == Run.id, other.carries, waits).exists()
    chosen = sa.or_(Run.removed.is_not(None), ~_kept()) if age is None else Run.removed <= at - age
    return Run.state.in_(ENDED), Run.purged.is_(None), ~signed, ~carried, chosen


def _kept() -> sa.ColumnElement[bool]:
    """Pinned, the baseline of a run that is listed, of a campaign that states a requirement, or against such a one."""
    other = orm.aliased(Run)
    compared = sa.select(RunBaseline.run_id).join(other, other.id == RunBaseline.run_id)
    baseline = compared.where(RunBaseline.baseline == Run.id, other.removed.is_(None)).exists()
    required = sa.select(RunRequirement.run_id).where(RunRequirement.run_id == Run.id).exists()
    return sa.or_(Run.pinned, baseline, required, _against())


def _against() -> sa.ColumnElement[bool]:
    """It found a value that violates, or one beyond the horizon that bars "cleared", and a run asks the same question,
    perhaps within other bounds, for a requirement."""
    other = orm.aliased(Run)
    of = sa.select(kin(other)).join(RunRequirement, RunRequirement.run_id == other.id)
    asks = kin(Run).in_(of.where(other.question.is_not(None)))
    return sa.and_(sa.or_(violates(), Run.later.is_not(None)), Run.question.is_not(None), asks)


def violates() -> sa.ColumnElement[bool]:
    """Whether a run found a value at or below its threshold, or that of a listed run that asks the same for a
    requirement, whether it came to a verdict or not: what it cleared may violate where the threshold was raised."""
    other = orm.aliased(Run)
    of = sa.select(kin(other).label("kin"), sa.func.max(other.threshold).label("threshold"))
    of = of.join(RunRequirement, RunRequirement.run_id == other.id).where(other.removed.is_(None))
    highest = of.group_by("kin").subquery()
    required = sa.select(highest.c.threshold).where(highest.c.kin == kin(Run)).correlate(Run).scalar_subquery()
    return sa.or_(Run.verdict == VerdictWord.VIOLATED, at_or_below(Run.threshold), at_or_below(required))


def _pragma(reader: sa.Connection, name: str) -> int:
    return int(reader.exec_driver_sql(f"PRAGMA {name}").scalar_one())


def _size(reader: sa.Connection, run_id: int) -> int:
    chunk = EvaluationChunk
    columns = (chunk.points, chunk.costs, chunk.status, chunk.seconds)
    evaluations = sa.select(sa.func.sum(sum(sa.func.length(c) for c in columns))).where(chunk.run_id == run_id)
    flights = sa.select(sa.func.sum(sa.func.length(Trace.data))).where(Trace.run_id == run_id)
    return int(reader.scalar(evaluations) or 0) + int(reader.scalar(flights) or 0)
