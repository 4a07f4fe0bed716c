"""The two ways on for a run that waits for the code that began it, besides a worker of that code.

`restart` discards what was evaluated; `carry` begins a new run, whose worker takes over what it may use of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

import sqlalchemy as sa

from backend.db import groups, refusals, reset
from backend.db.continuation import store_text, succeed
from backend.db.engine import now
from backend.db.tables import Run, RunText, Stage, SweepRun, Worker
from backend.db.workers import beating
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.runs import RunState, run_name
from campaigns.stages.plan import most

BEGUN = sa.or_(Run.flown.is_not(None), Run.evaluations > 0, sa.exists().where(Stage.run_id == Run.id))
"""Whether a run has been begun; earlier versions stored no code with it."""
CONTINUED = "It was continued as {run}."


def restart(writer: sa.Connection, run_id: int, needs: str | None = None) -> None:
    """Put a run that `waits` back to where it was when it was submitted.

    needs: the simulator that it needs from then on, if not the same as before.
    """
    reset.empty(writer, run_id)
    changed = {} if needs is None else {"needs": needs}
    writer.execute(sa.update(Run).where(Run.id == run_id).values(carries=False, **changed))


def carry(writer: sa.Connection, run_id: int, campaign: Campaign, catalogue: Catalogue) -> int:
    """Queue a new run that continues one that `waits`, which is cancelled."""
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
    if row is None:
        return False
    refused = refusals.of(writer, [run_id]).get(run_id, {})
    shown = (Worker.installation, Worker.simulators, Worker.draining)
    live = writer.execute(sa.select(*shown).where(beating(now(writer)))).all()
    if not refused and not has_changed(row.needs, [here.simulators for here in live]):
        return False
    others = [here for here in live if here.installation not in refused and not here.draining]
    return not any(row.needs is None or row.needs in here.simulators for here in others)


def has_changed(needs: str | None, workers: Iterable[Collection[str]]) -> bool:
    """Whether workers with these simulators have the one that a run needs, but none as it was at submission."""
    known = {version for simulators in workers for version in simulators}
    name = (needs or "").partition("@")[0]
    return needs is not None and needs not in known and any(version.partition("@")[0] == name for version in known)


def _group(reader: sa.Connection, run_id: int) -> str | None:
    return groups.of_runs(reader, [run_id])[run_id].group
