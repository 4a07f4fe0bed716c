"""The two ways on for a run that waits for the code that began it, besides a worker of that code.

`restart` discards what was evaluated; `carry` begins a new run, whose worker takes over what it may use of it.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import groups, refusals, reset
from backend.db.continuation import store_text, succeed
from backend.db.engine import now
from backend.db.tables import Run, RunText, Stage, SweepRun, Worker
from backend.db.workers import SEEN
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.runs import RunState, run_name
from campaigns.stages.plan import most

BEGUN = sa.or_(Run.flown.is_not(None), Run.evaluations > 0, sa.exists().where(Stage.run_id == Run.id))
"""Whether a run has been begun; earlier versions stored no code with it."""
CONTINUED = "It was continued as {run}."


def restart(writer: sa.Connection, run_id: int) -> bool:
    """Put a waiting run back to where it was when it was submitted; false if it does not wait for its code."""
    if not waits(writer, run_id):
        return False
    reset.empty(writer, run_id)
    writer.execute(sa.update(Run).where(Run.id == run_id).values(carries=False))
    return True


def carry(writer: sa.Connection, run_id: int, campaign: Campaign, catalogue: Catalogue) -> int | None:
    """Queue a new run that continues a waiting one, which is cancelled; None if it does not wait for its code."""
    if not waits(writer, run_id):
        return None
    planned = most(campaign)
    found = succeed(writer, run_id, campaign, planned, catalogue, carries=True)
    _place(writer, run_id, found)
    ended = {"state": RunState.CANCELLED, "finished": now(writer)}
    ended |= {"error": CONTINUED.format(run=run_name(found))}
    writer.execute(sa.update(Run).where(Run.id == run_id).values(**ended))
    return found


def _place(writer: sa.Connection, run_id: int, successor: int) -> None:
    """Give the successor the text of the campaign, and the place in a group and in a sweep."""
    text = writer.scalar(sa.select(RunText.text).where(RunText.run_id == run_id))
    if text is not None:
        store_text(writer, successor, text)
    if (group := _group(writer, run_id)) is not None:
        groups.store(writer, successor, group)
    writer.execute(sa.update(SweepRun).where(SweepRun.run_id == run_id).values(run_id=successor))


def waits(writer: sa.Connection, run_id: int) -> bool:
    """Whether a run waits for other code than that of the workers which take runs; locks it until the transaction ends,
    its group first, as a submission does."""
    if (group := _group(writer, run_id)) is not None:
        groups.lock(writer, group)
    queued = sa.select(Run.needs).where(Run.id == run_id, Run.state == RunState.QUEUED)
    row = writer.execute(queued.with_for_update()).one_or_none()
    refused = refusals.of(writer, [run_id]).get(run_id)
    if row is None or not refused:
        return False
    live = sa.select(Worker.installation, Worker.simulators).where(Worker.beat > now(writer) - SEEN, ~Worker.draining)
    others = [here for here in writer.execute(live) if here.installation not in refused]
    return not any(row.needs is None or row.needs in here.simulators for here in others)


def _group(reader: sa.Connection, run_id: int) -> str | None:
    return groups.of_runs(reader, [run_id])[run_id].group
