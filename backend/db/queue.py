"""The runs table as a queue: leases, fences, attempts, cancelling. The one place that changes a run's state.

A worker claims a run for `lease` seconds and beats before they are over; a run whose lease has run out is free for
another. Every claim raises the run's fence, and every write names the fence it was made under, so that a worker that
was only slow cannot write over its successor (Kleppmann, "How to do distributed locking"). SQLite: BEGIN IMMEDIATE;
PostgreSQL: FOR UPDATE SKIP LOCKED (SQLite has no such words, and needs none). Start reading at `Queue.claim`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import sqlalchemy as sa

from backend.db import snapshots
from backend.db.engine import insert, now, read
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run, Stage
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.documents import JsonObject
from campaigns.runs import HELD

LEASE = 10.0
"""How long a worker may be silent before its run is given to another [s]."""

LONGEST_ERROR = 4000
"""Characters kept of a sentence that says why an attempt failed."""

_SILENT = "its worker stopped sending heartbeats"
_CLAIMED = (Run.id, Run.state, Run.fence, Run.attempts, Run.max_attempts, Run.started, Run.campaign_digest)


class LostLease(RuntimeError):
    """The run was given to another worker or has ended; nothing was written."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__(message or type(self).__doc__)


@dataclass(frozen=True)
class Claim:
    """A run held by a worker: which, under which fence, in which attempt since the last completed stage."""

    run_id: int
    fence: int
    attempt: int
    max_attempts: int
    worker: str
    document: JsonObject
    """The campaign."""

    def as_json(self) -> JsonObject:
        """The claim as plain JSON values; `Claim(**values)` is the way back."""
        return asdict(self)


def submit(
    connection: sa.Connection,
    campaign: Campaign,
    *,
    name: str,
    tags: Sequence[str],
    owner: str,
    planned: int,
    priority: int = 0,
    catalogue: Catalogue | None = None,
) -> int:
    """Put a run of the campaign into the queue, in the caller's transaction; returns its number.

    Of the catalogue it keeps what the campaign's components mean.
    """
    created = now(connection)
    row = {"digest": campaign.digest, "name": campaign.name, "document": campaign.document(), "created": created}
    connection.execute(insert(connection, CampaignRow).values(**row).on_conflict_do_nothing())
    values = {
        "campaign_digest": campaign.digest,
        "name": name,
        "tags": list(tags),
        "owner": owner,
        "created": created,
        "priority": priority,
        "planned": planned,
        "threshold": campaign.criterion.threshold,
        "snapshot": None if catalogue is None else snapshots.keep(connection, campaign, catalogue),
    }
    return int(connection.execute(sa.insert(Run).values(**values).returning(Run.id)).scalar_one())


def request_cancel(connection: sa.Connection, run_id: int) -> str | None:
    """Cancel a run: at once when no living worker holds it, otherwise its worker is asked to. Returns its state.

    None when there is no such run; a run that has ended stays as it is.
    """
    at = now(connection)
    unheld = sa.or_(Run.state == "queued", sa.and_(Run.state.in_(HELD), Run.lease_until < at))
    ended = {"state": "cancelled", "cancel": True, "finished": at, "lease_until": 0.0, "error": None}
    connection.execute(sa.update(Run).where(Run.id == run_id, unheld).values(**ended))
    asked = {"state": "cancelling", "cancel": True}
    connection.execute(sa.update(Run).where(Run.id == run_id, Run.state == "running").values(**asked))
    return connection.scalar(sa.select(Run.state).where(Run.id == run_id))


def fenced(connection: sa.Connection, claim: Claim, **values: Any) -> None:
    """Update the claimed run, in the caller's transaction; raises `LostLease` when it is no longer the caller's."""
    mine = (Run.id == claim.run_id, Run.fence == claim.fence, Run.state.in_(HELD))
    if connection.execute(sa.update(Run).where(*mine).values(**values)).rowcount != 1:
        raise LostLease(f"run {claim.run_id} was reassigned to another worker or has ended; nothing was written")


class Queue:
    """The queue as a worker sees it. Every method is one transaction; database errors pass through."""

    def __init__(self, engine: sa.Engine, lease: float = LEASE) -> None:
        self.engine, self.lease = engine, lease

    def claim(self, worker: str) -> Claim | None:
        """The next run, held under a new fence; None when there is none.

        Order: priority, then the owner with the fewest runs in work, then age. Runs found to be beyond help on the way
        (cancelled while their worker was gone, or out of attempts) are ended.
        """
        while self._any_ready():
            with self.engine.begin() as connection:
                at = now(connection)
                row = connection.execute(self._next(at)).first()
                if row is None:
                    return None
                if not self._ended(connection, row, at):
                    return self._hold(connection, row, at, worker)
        return None

    def beat(self, claim: Claim) -> bool:
        """Prolong the lease; true when the run is to be cancelled. Raises `LostLease`."""
        with self.engine.begin() as connection:
            fenced(connection, claim, lease_until=now(connection) + self.lease)
            return connection.scalar(sa.select(Run.state).where(Run.id == claim.run_id)) == "cancelling"

    def cancel_requested(self, claim: Claim) -> bool:
        """Whether the run is to be cancelled, or is no longer held under this claim; only reads."""
        mine = sa.select(Run.state).where(Run.id == claim.run_id, Run.fence == claim.fence)
        with read(self.engine) as connection:
            return connection.scalar(mine) != "running"

    def retry(self, claim: Claim, how: str, *, delay: float = 0.5) -> None:
        """The attempt failed: queue the run again after a pause that doubles, or fail it when that was the last.

        `how` is a sentence without its full stop; `delay` is the first pause [s]. A run being cancelled is cancelled.
        """
        with self.engine.begin() as connection:
            row = _locked(connection, claim)
            if row.state == "cancelling":
                return self._end(connection, claim, "cancelled")
            if row.attempts >= row.max_attempts:
                sentence = _given_up(connection, claim.run_id, row.attempts, how)
                return self._end(connection, claim, "failed", sentence)
            pause = min(60.0, delay * 2 ** (row.attempts - 1))
            sentence = f"Attempt {row.attempts} of {row.max_attempts}: {how}."[:LONGEST_ERROR]
            free = {"state": "queued", "lease_until": 0.0, "not_before": now(connection) + pause, "error": sentence}
            return fenced(connection, claim, **free)

    def give_back(self, claim: Claim) -> None:
        """The worker stops in good order: the run is free at once, and this attempt does not count."""
        with self.engine.begin() as connection:
            row = _locked(connection, claim)
            if row.state == "cancelling":
                return self._end(connection, claim, "cancelled")
            free = {"state": "queued", "lease_until": 0.0, "not_before": 0.0, "attempts": max(0, row.attempts - 1)}
            return fenced(connection, claim, **free)

    def fail(self, claim: Claim, why: str) -> None:
        """End the run as failed, with the sentence that says why; no further attempt is made."""
        with self.engine.begin() as connection:
            self._end(connection, claim, "failed", why)

    def cancelled(self, claim: Claim) -> None:
        """End the run as cancelled: its worker has stopped working on it."""
        with self.engine.begin() as connection:
            self._end(connection, claim, "cancelled")

    def _end(self, connection: sa.Connection, claim: Claim, state: str, error: str | None = None) -> None:
        error = error and error[:LONGEST_ERROR]
        fenced(connection, claim, state=state, finished=now(connection), lease_until=0.0, error=error)

    def _any_ready(self) -> bool:
        """Asked first, so that an idle worker only ever reads."""
        with read(self.engine) as connection:
            found = sa.select(Run.id).where(_ready(now(connection))).limit(1)
            return connection.scalar(found) is not None

    def _next(self, at: float) -> sa.Executable:
        held = sa.select(Run.owner, sa.func.count().label("held")).where(Run.state.in_(HELD), Run.lease_until >= at)
        share = held.group_by(Run.owner).subquery()
        fewest = sa.func.coalesce(sa.select(share.c.held).where(share.c.owner == Run.owner).scalar_subquery(), 0)
        order = (Run.priority.desc(), fewest, Run.created, Run.id)
        return (
            sa.select(*_CLAIMED).where(_ready(at)).order_by(*order).limit(1).with_for_update(skip_locked=True, of=Run)
        )

    def _ended(self, connection: sa.Connection, row: Any, at: float) -> bool:
        values: JsonObject = {"finished": at, "lease_until": 0.0, "fence": row.fence + 1}
        if row.state == "cancelling":
            values |= {"state": "cancelled", "error": None}
        elif row.attempts >= row.max_attempts:
            values |= {"state": "failed", "error": _given_up(connection, row.id, row.attempts, _SILENT)}
        else:
            return False
        connection.execute(sa.update(Run).where(Run.id == row.id).values(**values))
        return True

    def _hold(self, connection: sa.Connection, row: Any, at: float, worker: str) -> Claim:
        values: JsonObject = {"state": "running", "worker": worker, "fence": row.fence + 1}
        values |= {"attempts": row.attempts + 1, "lease_until": at + self.lease}
        values |= {"started": at if row.started is None else row.started}
        if row.state == "running":
            values |= {"error": f"Attempt {row.attempts} of {row.max_attempts}: {_SILENT}."}
        connection.execute(sa.update(Run).where(Run.id == row.id).values(**values))
        of = sa.select(CampaignRow.document).where(CampaignRow.digest == row.campaign_digest)
        document = connection.execute(of).scalar_one()
        return Claim(row.id, row.fence + 1, row.attempts + 1, row.max_attempts, worker, document)


def _locked(connection: sa.Connection, claim: Claim) -> sa.Row[str, int, int]:
    mine = sa.select(Run.state, Run.attempts, Run.max_attempts).where(Run.id == claim.run_id, Run.fence == claim.fence)
    row = connection.execute(mine.with_for_update()).first()
    if row is None:
        raise LostLease
    return row


def _ready(at: float) -> sa.ColumnElement[bool]:
    return sa.or_(
        sa.and_(Run.state == "queued", Run.not_before <= at),
        sa.and_(Run.state.in_(HELD), Run.lease_until < at),
    )


def _given_up(connection: sa.Connection, run_id: int, attempts: int, how: str) -> str:
    """Why no further attempt is made: how often, where, and how the last one ended."""
    running = sa.select(Stage.kind, Stage.method).where(Stage.run_id == run_id, Stage.state == "running")
    stage = connection.execute(running.order_by(Stage.position)).first()
    where = "before its first stage"
    if stage is not None:
        where = f"in the {stage.kind} stage" + (f" ({stage.method})" if stage.method else "")
    return f"Failed after {attempts} attempts {where}; last attempt: {how}."
