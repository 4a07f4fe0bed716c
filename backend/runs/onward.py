"""Ways on for a run that has failed, or that other code began: begin it again, or continue it as a new run.

See `backend.runs.waiting`.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.access.own import require_own
from backend.catalog.service import required
from backend.db import audit, queue, waiting
from backend.db.access import Visitor
from backend.db.tables import Run
from backend.http.errors import RefusedError
from backend.runs import identity, service
from backend.runs.quota import Quota, refuse_beyond
from backend.runs.removal import refuse_removed
from backend.runs.schemas import RunSummary
from campaigns import Campaign, Catalogue
from campaigns.runs import run_name

PUT_BACK = "Put back what is missing first, then begin it again; nothing was discarded"
"""The way on if a run cannot begin again with what is installed."""


def retry(writer: sa.Connection, run_id: int, visitor: Visitor, quota: Quota) -> RunSummary:
    """Queue a failed run again with what is stored of it; 409 unless it has failed, or if it is removed.

    Evaluations of which none has a value are discarded, which the trail states.
    """
    _own(writer, run_id, visitor)
    refuse_removed(writer, run_id)
    stored, error = writer.execute(sa.select(Run.evaluations, Run.error).where(Run.id == run_id)).one()
    refuse_beyond(writer, quota, visitor)
    if not queue.resume(writer, run_id):
        raise RefusedError("not-failed", f"{run_name(run_id)} has not failed; only a failed run is retried")
    kept = writer.execute(sa.select(Run.evaluations).where(Run.id == run_id)).scalar_one()
    discarded = {"discarded": stored - kept} if kept < stored else {}
    audit.note(writer, visitor, "run.retried", run_name(run_id), {"evaluations": kept, "error": error, **discarded})
    return service.summary(writer, run_id)


def restart(writer: sa.Connection, run_id: int, visitor: Visitor) -> RunSummary:
    """Begin a run again without its evaluations, with the simulator as it is now; 409 unless it waits for its code or
    if the newest worker cannot run it, 403 if it is another user's."""
    _own(writer, run_id, visitor)
    _waits(writer, run_id)
    _runnable(writer, run_id)
    lost = writer.scalar(sa.select(Run.evaluations).where(Run.id == run_id))
    waiting.restart(writer, run_id, _changed_simulator(writer, run_id))
    audit.note(writer, visitor, "run.restarted", run_name(run_id), {"evaluations": lost})
    return service.summary(writer, run_id)


def carry_on(writer: sa.Connection, run_id: int, visitor: Visitor, quota: Quota) -> RunSummary:
    """Continue a run as a new one; as `restart`, and 409 if nothing of it can be used here."""
    _own(writer, run_id, visitor)
    _waits(writer, run_id)
    refuse_beyond(writer, quota, visitor, more=0)
    found = waiting.carry(writer, run_id, *_usable(writer, run_id))
    audit.note(writer, visitor, "run.continued", run_name(found), {"continues": run_name(run_id)})
    return service.summary(writer, found)


def now(reader: sa.Connection, made: RunSummary) -> RunSummary:
    """The run of an earlier answer, as it is by now."""
    return service.summary(reader, service.number(made.id))


def _changed_simulator(reader: sa.Connection, run_id: int) -> str | None:
    """The published version of the simulator that a run needs; None if that is the same."""
    needs = reader.scalar(sa.select(Run.needs).where(Run.id == run_id))
    entry = None if needs is None else required(reader).simulator(needs.partition("@")[0])
    return None if entry is None or needs in entry.versions else entry.version


def _runnable(reader: sa.Connection, run_id: int) -> None:
    """409 if the newest worker cannot run the campaign: begun again, it would fail without its evaluations."""
    if detail := identity.unusable(run_id, service.campaign(reader, run_id), required(reader)):
        raise RefusedError("not-continuable", f"{detail}. {PUT_BACK}")


def _usable(reader: sa.Connection, run_id: int) -> tuple[Campaign, Catalogue]:
    campaign, catalogue = service.campaign(reader, run_id), required(reader)
    if detail := identity.not_continuable(reader, run_id, campaign, catalogue):
        raise RefusedError("not-continuable", detail)
    return campaign, catalogue


def _own(reader: sa.Connection, run_id: int, visitor: Visitor) -> None:
    service.require(reader, run_id)
    require_own(visitor, reader.scalar(sa.select(Run.owner).where(Run.id == run_id)), run_name(run_id))


def _waits(writer: sa.Connection, run_id: int) -> None:
    """409 unless it waits for its code; locks it until the transaction ends."""
    if not waiting.waits(writer, run_id):
        what = "does not wait for the code that began it; only such a run is begun again or continued"
        raise RefusedError("not-waiting", f"{run_name(run_id)} {what}")
