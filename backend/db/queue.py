"""The runs table as a queue: leases, fences, attempts, cancellation. Only this module changes a run's state.

A worker claims a run for `lease` seconds and renews the lease by heartbeats; a run whose lease has expired can be
claimed by another worker. An attempt that ended by itself counts against the run; a worker that was lost from outside
is counted apart, with a higher limit; a stored evaluation ends both counts. Every claim increments the run's fencing
token, and every write checks it, so that a worker that was only slow cannot overwrite its successor's results
(Kleppmann, "How to do distributed locking"). SQLite: BEGIN IMMEDIATE; PostgreSQL: FOR UPDATE SKIP LOCKED.
Start reading at `Queue.claim`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import labels, numbers, questions, refusals, reset, sizes, snapshots
from backend.db.engine import insert, now, read
from backend.db.leases import Leases, doubtful
from backend.db.losses import LOSSES, MOST_LOSSES, SILENT, failed_after, lost
from backend.db.outages import storable
from backend.db.tables import CampaignRow, Run, RunRequirement, Stage
from backend.db.tables_installed import WebhookDelivery
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.runs import HELD, RunState, StageState
from campaigns.sample_seed import SampleSeed

LEASE = 10.0
"""How long a worker may send no heartbeat before its run can be claimed by another [s]."""

LONGEST_PAUSE, LONGEST_PAUSE_AFTER_LOSS = 60.0, 5.0
"""Between two attempts [s]."""

_CLAIMED = (
    Run.id, Run.state, Run.fence, Run.attempts, Run.max_attempts, Run.losses, Run.started, Run.advanced,
    Run.campaign_digest,
)  # fmt: skip


class LostLease(RuntimeError):
    """The run was reassigned to another worker or has ended; nothing was written."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__(message or type(self).__doc__)


@dataclass(frozen=True)
class Claim:
    """A run claimed by a worker: its number, the fence, and the attempt since the last stored evaluation."""

    run_id: int
    fence: int
    attempt: int
    max_attempts: int
    worker: str
    document: dict[str, object]
    """The campaign."""

    def as_json(self) -> dict[str, object]:
        """The claim as plain JSON values; `Claim(**values)` restores it."""
        return asdict(self)


def submit(
    connection: sa.Connection,
    campaign: Campaign,
    *,
    name: str,
    tags: Sequence[str],
    owner: str,
    planned: int,
    token: str | None = None,
    priority: int = 0,
    catalogue: Catalogue | None = None,
    labelled: Mapping[str, str] | None = None,
    seed: SampleSeed | None = None,
) -> int:
    """Queue a run of the campaign in the caller's transaction; returns its number.

    Stores the catalogue entries of the campaign's components with it; labelled: its labels; seed: that of its
    independent sample, drawn here if none is stated.
    """
    seed = seed or SampleSeed.drawn()
    created = now(connection)
    document = campaign.document()
    row = {"digest": campaign.digest, "name": campaign.name, "document": document, "created": created}
    row |= {"seedless": campaign.seedless}
    connection.execute(insert(connection, CampaignRow).values(**row).on_conflict_do_nothing())
    needed = None if campaign.simulator is None or catalogue is None else catalogue.simulator(campaign.simulator.name)
    values = {
        "campaign_digest": campaign.digest,
        **questions.store(connection, campaign, catalogue),
        "name": name,
        "tags": list(tags),
        "owner": owner,
        "token": token,
        "created": created,
        "priority": priority,
        "planned": planned,
        "threshold": campaign.criterion.threshold,
        "snapshot": None if catalogue is None else snapshots.store(connection, campaign, catalogue),
        "needs": None if needed is None else needed.version,
        "size": sizes.of_document(document),
        "sample_seed": seed.value,
        "sample_seed_stated": seed.stated,
    }
    values |= numbers.following(connection, Run)
    run_id = int(connection.execute(sa.insert(Run).values(**values).returning(Run.id)).scalar_one())
    labels.store(connection, run_id, labelled or {})
    if stated := campaign.criterion.requirements:
        rows = [{"requirement": one.id, "text": one.text, "run_id": run_id} for one in stated]
        connection.execute(sa.insert(RunRequirement), rows)
    return run_id


def request_cancel(connection: sa.Connection, run_id: int) -> RunState | None:
    """Cancel a run: immediately if no live worker holds it, otherwise by a request to its worker. Returns its state.

    None if there is no such run; a run that has ended is unchanged.
    """
    at = now(connection)
    unheld = sa.or_(Run.state == RunState.QUEUED, sa.and_(Run.state.in_(HELD), Run.lease_until < at))
    ended = {"state": RunState.CANCELLED, "finished": at, "lease_until": 0.0, "error": None}
    connection.execute(sa.update(Run).where(Run.id == run_id, unheld).values(**ended))
    cancel_request = sa.update(Run).where(Run.id == run_id, Run.state == RunState.RUNNING)
    connection.execute(cancel_request.values(state=RunState.CANCELLING))
    return connection.scalar(sa.select(Run.state).where(Run.id == run_id))


def resume(connection: sa.Connection, run_id: int) -> bool:
    """Queue a failed run again; false if it has not failed.

    It keeps what is stored of it, unless no evaluation has a value: these are made again.
    """
    failed = (Run.id == run_id, Run.state == RunState.FAILED)
    again = {"state": RunState.QUEUED, "attempts": 0, "losses": 0, "not_before": 0.0, "finished": None, "error": None}
    if connection.execute(sa.update(Run).where(*failed).values(**again)).rowcount != 1:
        return False
    if reset.useless(connection, run_id):
        reset.empty(connection, run_id)
    # Its end is reported again.
    connection.execute(sa.delete(WebhookDelivery).where(WebhookDelivery.run_id == run_id))
    return True


def fenced(connection: sa.Connection, claim: Claim, **values: Any) -> None:
    """Update the claimed run in the caller's transaction; raises `LostLease` if the claim is no longer valid."""
    mine = (Run.id == claim.run_id, Run.fence == claim.fence, Run.state.in_(HELD))
    if connection.execute(sa.update(Run).where(*mine).values(**values)).rowcount != 1:
        raise LostLease(f"run {claim.run_id} was reassigned to another worker or has ended; nothing was written")


class Queue:
    """The worker's interface to the queue. Every method is one transaction; database errors are not caught."""

    def __init__(self, engine: sa.Engine, lease: float = LEASE) -> None:
        self.engine, self.lease = engine, lease
        self._leases = Leases()

    def claim(self, worker: str, simulators: Sequence[str] = (), installation: str = "") -> Claim | None:
        """Claim the next run under a new fence; None if there is none for a worker with these simulators and this code.

        Order: priority, then the owner with the fewest active runs, then age. Runs that cannot be retried (cancelled
        while their worker was gone, or out of attempts) are ended on the way.
        """
        able = partial(_able, simulators, installation)
        while self._any_ready(able):
            with self.engine.begin() as connection:
                at = now(connection)
                ready = sa.select(*_CLAIMED).where(self._ready(at), able(at)).order_by(*_order(at)).limit(1)
                row = connection.execute(ready.with_for_update(skip_locked=True, of=Run)).first()
                if row is None:
                    return None
                if not self._ended(connection, row, at):
                    return self._hold(connection, row, at, worker)
        return None

    def ready(self, simulators: Sequence[str] = (), installation: str = "") -> bool:
        """Whether there is a run to claim for such a worker."""
        return self._any_ready(partial(_able, simulators, installation))

    def free(self) -> None:
        """Queue the runs of lost workers that no other one has taken since, so that each states what it waits for.

        Called by every worker with its heartbeats, because those that take runs may be unable to continue these.
        """
        longest = _longest(self.lease)
        with read(self.engine) as connection:
            self._leases.look(connection, now(connection), longest)
        if not (stuck := self._leases.stuck(longest)):
            return
        with self.engine.begin() as connection:
            at = now(connection)
            gone = sa.select(*_CLAIMED).where(Run.id.in_(stuck), doubtful(at, longest))
            for row in connection.execute(gone.with_for_update(skip_locked=True)).all():
                if not self._ended(connection, row, at):
                    values = {"state": RunState.QUEUED, "lease_until": 0.0, "attempts": max(0, row.attempts - 1)}
                    values |= {"fence": row.fence + 1, "losses": row.losses + 1, "error": lost(row.losses + 1, SILENT)}
                    connection.execute(sa.update(Run).where(Run.id == row.id).values(**values))

    def shared(
        self, worker: str, simulators: Sequence[str] = (), installation: str = "", without: Collection[int] = ()
    ) -> Claim | None:
        """The claim under which another worker holds a run that it shares: a sample of which blocks are left to fly.

        Whoever writes under it stops when its holder loses it. without: runs that are left out. None if there is none.
        """
        drawing = (Stage.run_id == Run.id, Stage.state == StageState.RUNNING, Stage.counted > 0)
        left = sa.select(Stage.run_id).where(*drawing, Stage.counted - Stage.excluded < Stage.planned).exists()
        conditions = (Run.state == RunState.RUNNING, Run.worker != worker, Run.id.not_in(without), left)
        query = sa.select(*_CLAIMED, CampaignRow.document).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        with read(self.engine) as connection:
            at = now(connection)
            query = query.where(*conditions, Run.lease_until >= at, _able(simulators, installation, at))
            for row in connection.execute(query.order_by(Run.priority.desc(), Run.id)):
                with suppress(ValidationError):  # of a newer version, whose workers share it
                    if Campaign.model_validate(row.document).shared:
                        return Claim(row.id, row.fence, row.attempts, row.max_attempts, worker, row.document)
        return None

    def beat(self, claim: Claim) -> bool:
        """Extend the lease; true if cancellation was requested. Raises `LostLease`."""
        with self.engine.begin() as connection:
            fenced(connection, claim, lease_until=now(connection) + self.lease)
            return connection.scalar(sa.select(Run.state).where(Run.id == claim.run_id)) == RunState.CANCELLING

    def cancel_requested(self, claim: Claim) -> bool:
        """Whether cancellation was requested or this claim is no longer valid; read-only."""
        mine = sa.select(Run.state).where(Run.id == claim.run_id, Run.fence == claim.fence)
        with read(self.engine) as connection:
            return connection.scalar(mine) != RunState.RUNNING

    def retry(self, claim: Claim, how: str, *, delay: float = 0.5) -> None:
        """Queue the run again after a failed attempt, with a doubling pause; fail it after the last attempt.

        `how` is a sentence without its full stop; `delay` is the first pause [s]. A run in state cancelling is
        cancelled instead.
        """
        with self.engine.begin() as connection:
            row = _locked(connection, claim)
            if row.state == RunState.CANCELLING:
                return self._end(connection, claim, RunState.CANCELLED)
            if row.attempts >= row.max_attempts:
                sentence = failed_after(connection, claim.run_id, row.attempts, how)
                return self._end(connection, claim, RunState.FAILED, sentence)
            pause = min(LONGEST_PAUSE, delay * 2 ** (row.attempts - 1))
            sentence = storable(f"Attempt {row.attempts} of {row.max_attempts}: {how}.")
            later = {"lease_until": 0.0, "not_before": now(connection) + pause, "error": sentence}
            return fenced(connection, claim, state=RunState.QUEUED, **later)

    def lost(self, claim: Claim, how: str, *, delay: float = 0.5) -> None:
        """Queue the run again after its worker's process was killed from outside; as `retry`, but this attempt does not
        count, and losses have a limit of their own."""
        with self.engine.begin() as connection:
            row = _locked(connection, claim)
            if row.state == RunState.CANCELLING:
                return self._end(connection, claim, RunState.CANCELLED)
            losses = row.losses + 1
            if losses >= MOST_LOSSES:
                sentence = failed_after(connection, claim.run_id, losses, how, LOSSES)
                return self._end(connection, claim, RunState.FAILED, sentence)
            pause = min(LONGEST_PAUSE_AFTER_LOSS, delay * 2**row.losses)
            later = {"lease_until": 0.0, "not_before": now(connection) + pause, "error": lost(losses, how)}
            later |= {"attempts": max(0, row.attempts - 1), "losses": losses}
            return fenced(connection, claim, state=RunState.QUEUED, **later)

    def give_back(self, claim: Claim) -> None:
        """Release the run on an orderly shutdown of the worker; this attempt does not count."""
        with self.engine.begin() as connection:
            self._release(connection, claim)

    def put_off(self, claim: Claim, why: str, delay: float) -> None:
        """Release the run, the database being unusable, for an attempt after `delay` [s]; this one does not count."""
        with self.engine.begin() as connection:
            self._release(connection, claim, error=storable(f"Put off: {why}."), not_before=now(connection) + delay)

    def refuse(self, claim: Claim, installation: str, text: str) -> None:
        """Return a run that other code began to the queue, for a worker of another installation; no attempt counts."""
        with self.engine.begin() as connection:
            self._release(connection, claim, error=None)
            refusals.store(connection, claim.run_id, installation, text)

    def fail(self, claim: Claim, why: str) -> None:
        """End the run as failed with the reason `why`; there is no further attempt."""
        with self.engine.begin() as connection:
            self._end(connection, claim, RunState.FAILED, why)

    def cancelled(self, claim: Claim) -> None:
        with self.engine.begin() as connection:
            self._end(connection, claim, RunState.CANCELLED)

    def _release(self, connection: sa.Connection, claim: Claim, **more: object) -> None:
        row = _locked(connection, claim)
        if row.state == RunState.CANCELLING:
            return self._end(connection, claim, RunState.CANCELLED)
        free = {"state": RunState.QUEUED, "lease_until": 0.0, "not_before": 0.0, "attempts": max(0, row.attempts - 1)}
        return fenced(connection, claim, **free | more)

    def _end(self, connection: sa.Connection, claim: Claim, state: RunState, error: str | None = None) -> None:
        error = error and storable(error)
        fenced(connection, claim, state=state, finished=now(connection), lease_until=0.0, error=error)

    def _any_ready(self, able: Callable[[float], sa.ColumnElement[bool]]) -> bool:
        """Checked before claiming, so that an idle worker never writes."""
        with read(self.engine) as connection:
            at = now(connection)
            self._leases.look(connection, at, _longest(self.lease))
            return connection.scalar(sa.select(Run.id).where(self._ready(at), able(at)).limit(1)) is not None

    def _ready(self, at: float) -> sa.ColumnElement[bool]:
        """A lease too far ahead counts as expired if its worker is gone."""
        stuck = self._leases.stuck(_longest(self.lease))
        gone = sa.and_(Run.id.in_(stuck), doubtful(at, _longest(self.lease)))
        return sa.or_(_ready(at), gone) if stuck else _ready(at)

    def _ended(self, connection: sa.Connection, row: Any, at: float) -> bool:
        values: dict[str, object] = {"finished": at, "lease_until": 0.0, "fence": row.fence + 1}
        if row.state == RunState.CANCELLING:
            values |= {"state": RunState.CANCELLED, "error": None}
        elif row.state == RunState.RUNNING and row.losses + 1 >= MOST_LOSSES:
            sentence = failed_after(connection, row.id, MOST_LOSSES, SILENT, LOSSES)
            values |= {"state": RunState.FAILED, "error": sentence}
        else:
            return False
        connection.execute(sa.update(Run).where(Run.id == row.id).values(**values))
        return True

    def _hold(self, connection: sa.Connection, row: Any, at: float, worker: str) -> Claim:
        values: dict[str, object] = {"state": RunState.RUNNING, "worker": worker, "fence": row.fence + 1}
        attempt = row.attempts + 1
        if row.state == RunState.RUNNING:  # its worker is lost
            attempt = max(1, row.attempts)
            values |= {"losses": row.losses + 1, "error": lost(row.losses + 1, SILENT)}
        values |= {"attempts": attempt, "lease_until": at + self.lease}
        values |= {"started": at if row.started is None else row.started}
        waited = attempt == 1 and row.losses == 0 and row.state == RunState.QUEUED  # and nothing went wrong
        if waited or row.advanced is None:
            values["advanced"] = at
        connection.execute(sa.update(Run).where(Run.id == row.id).values(**values))
        of = sa.select(CampaignRow.document).where(CampaignRow.digest == row.campaign_digest)
        document = connection.execute(of).scalar_one()
        return Claim(row.id, row.fence + 1, attempt, row.max_attempts, worker, document)


def _locked(connection: sa.Connection, claim: Claim) -> sa.Row[RunState, int, int, int]:
    attempts_query = sa.select(Run.state, Run.attempts, Run.max_attempts, Run.losses)
    mine = attempts_query.where(Run.id == claim.run_id, Run.fence == claim.fence)
    row = connection.execute(mine.with_for_update()).first()
    if row is None:
        raise LostLease
    return row


def waiting_order(at: float) -> sa.Select[int]:
    """The numbers of the runs that wait for a worker, in the order of claims as of now (it changes with the owners)."""
    return sa.select(Run.id).where(_ready(at), Run.state != RunState.CANCELLING).order_by(*_order(at))


def _order(at: float) -> tuple[Any, ...]:
    active = sa.select(Run.owner, sa.func.count().label("active")).where(Run.state.in_(HELD), Run.lease_until >= at)
    share = active.group_by(Run.owner).subquery()
    fewest = sa.func.coalesce(sa.select(share.c.active).where(share.c.owner == Run.owner).scalar_subquery(), 0)
    return (Run.priority.desc(), fewest, Run.created, Run.id)


def _ready(at: float) -> sa.ColumnElement[bool]:
    """A pause further ahead than any is given is over: the clock was put back."""
    due = sa.or_(Run.not_before <= at, Run.not_before > at + LONGEST_PAUSE)
    return sa.or_(sa.and_(Run.state == RunState.QUEUED, due), sa.and_(Run.state.in_(HELD), Run.lease_until < at))


def _longest(lease: float) -> float:
    """The longest lease that some worker may give [s]."""
    return max(lease, LEASE)


def _able(simulators: Sequence[str], installation: str, at: float) -> sa.ColumnElement[bool]:
    """Whether a worker with these simulators and this code may claim a run now; any may end one that is being
    cancelled."""
    has = sa.or_(Run.needs.is_(None), Run.needs.in_(simulators))
    return sa.or_(sa.and_(has, ~refusals.by(installation, at)), Run.state == RunState.CANCELLING)
