"""Why queued runs have not started, and what a running one does besides its stages."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import sqlalchemy as sa

from backend.db import refusals
from backend.db.engine import now
from backend.db.queue import waiting_order
from backend.db.space import VARIABLE
from backend.db.tables import Run, Worker
from backend.db.waiting import BEGUN, has_changed
from backend.db.workers import Doing, beating, last_seen
from backend.runs.schemas import RunDoing
from campaigns.claims.numbers import count
from campaigns.identity.identity import COMPONENTS, SIMULATORS
from campaigns.runs import RunState, run_name
from campaigns.versions import NOT_INSTALLED, OTHER_POINTS

MOST_NAMED = 3
"""Largest number of runs that are named as the reason why another one waits."""

SOON = "It starts automatically within a few seconds."
UNREPORTED = (
    "The worker that executed it has not reported since. It starts automatically when this one, or another, reports."
)
"""Of a run that is queued again: its worker was killed, or has just given it back."""
OLD_VERSION = (
    "A worker of the version that began it continues it, if it still runs or the database was not updated since"
)
UNIDENTIFIED = "is not identified"
"""As `campaigns.identity.identity.differences` says it of what is never the same, also with its files as they were."""
SAME_MACHINE = "A worker on a machine of the kind that began it continues it"
FILES_BACK = "Put these files back as they were, and it continues"
PUT_BACK = "Put its file back as it was, or start a worker that has it"
_COMPILING = "Compiling your closed loop{about}, once: it is stored for later runs."


class Waits(NamedTuple):
    """Why a run waits, a sentence; other_code: what differs from the code that began it, where it waits for that."""

    waits: str | None
    other_code: str | None = None


def reasons(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, Waits]:
    """Why runs wait: one for each of them that is queued.

    Times in it are rounded, so that a page that receives every change does not receive one every second.
    """
    if not run_ids:
        return {}
    shown = (Run.id, Run.needs, Run.not_before, Run.evaluations, BEGUN.label("begun"))
    query = sa.select(*shown).where(Run.id.in_(run_ids), Run.state == RunState.QUEUED)
    queued = reader.execute(query).all()
    if not queued:
        return {}
    at = now(reader)
    known = (Worker.run_id, Worker.simulators, Worker.installation, Worker.draining, Worker.short)
    live = reader.execute(sa.select(*known).where(beating(at))).all()
    if not live:
        text = no_worker(last_seen(reader), at)
        return {row.id: Waits(text) for row in queued}
    order = list(reader.scalars(waiting_order(at)))
    position = {run_id: k for k, run_id in enumerate(order, 1)}
    refused = refusals.of(reader, [row.id for row in queued])
    return {row.id: _of(row, live, at, position.get(row.id), refused.get(row.id, {})) for row in queued}


def doing(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, RunDoing]:
    """What the workers of these running runs do besides their stages; only of those that do anything."""
    if not run_ids:
        return {}
    query = sa.select(Worker.run_id, Worker.doing, Worker.name, Run.worker).join(Run, Run.id == Worker.run_id)
    live = sa.and_(Worker.run_id.in_(run_ids), Run.state == RunState.RUNNING, beating(now(reader)))
    found = {}
    for row in reader.execute(query.where(live)):
        known = Doing.of(row.doing, row.run_id) if row.name == row.worker else None
        if known is not None:
            found[row.run_id] = doing_of(known)
    return found


def doing_of(known: Doing) -> RunDoing:
    about = "" if known.seconds is None else f", about {max(1, math.ceil(known.seconds))} s"
    return RunDoing(sentence=_COMPILING.format(about=about), since=known.since, seconds=known.seconds)


def _of(row: Any, live: Sequence[Any], at: float, position: int | None, refused: Mapping[str, str]) -> Waits:
    able = [worker for worker in live if row.needs is None or row.needs in worker.simulators]
    if not able and has_changed(row.needs, [worker.simulators for worker in live]):
        changes = f"{SIMULATORS}/{row.needs.partition('@')[0]} has changed"
        return Waits(_other_code(changes, row.evaluations) if row.begun else _changed(changes), changes)
    if not able:
        return Waits(_no_simulator(row.needs or "", len(live)))
    same = [worker for worker in able if worker.installation not in refused]
    differs = next(reversed([*refused.values()]), None)
    if not same:
        return (
            Waits(_other_code(str(differs), row.evaluations), differs) if row.begun else Waits(_unknown(str(differs)))
        )
    willing = [worker for worker in same if not worker.draining]
    if not willing:
        return Waits(_draining(len(same)), differs if differs and row.begun else None)
    roomy = [worker for worker in willing if not worker.short]
    return Waits(_one(row, live, roomy, at, position) if roomy else _short(len(willing)))


def _one(row: Any, live: Sequence[Any], able: Sequence[Any], at: float, position: int | None) -> str:
    if row.not_before > at:
        return f"It is tried again in {10 * math.ceil((row.not_before - at) / 10)} s."
    able, live = ([worker for worker in some if worker.run_id != row.id] for some in (able, live))
    if not able:
        return UNREPORTED
    if all(worker.run_id is not None for worker in able):
        return _busy([worker.run_id for worker in able], len(live), position)
    if position is not None and position > 1:
        return f"Position {position} in the queue; it starts automatically."
    return SOON


def _busy(runs: Sequence[int], live: int, position: int | None) -> str:
    names = [run_name(run_id) for run_id in sorted(set(runs))]
    more = len(names) - MOST_NAMED
    listed = ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
    if len(runs) == 1:
        who = "The only worker is busy" if live == 1 else "The only worker that can execute it is busy"
    else:
        who = (
            f"All {len(runs)} workers are busy"
            if len(runs) == live
            else f"All {len(runs)} workers that can execute it are busy"
        )
    place = "" if position is None else f"; position {position} in the queue"
    return f"{who} with {listed}{place}. It starts automatically when one is free."


def no_worker(last: float | None, at: float) -> str:
    seen = "" if last is None else f"; the last one was seen {_ago(at - last)}"
    return f"No worker is running{seen}. Start one with `clearance worker`."


def _other_code(differs: str, evaluations: int) -> str:
    own = UNIDENTIFIED not in differs and any(f"{place}/" in differs for place in (COMPONENTS, SIMULATORS))
    who, way = "Other code began it than the running workers have", FILES_BACK if own else OLD_VERSION
    if NOT_INSTALLED in differs:  # neither could it be begun again
        return f"No running worker has what it needs: {differs}. {PUT_BACK}, and it continues with its evaluations."
    if differs.startswith(OTHER_POINTS):
        who, way = "No running worker can continue it", SAME_MACHINE
    return (
        f"{who}: {differs}. {way}; or begin it again, without its {count(evaluations)} evaluations; or continue it as "
        "a new run, with those that are still valid, if any."
    )


def _unknown(differs: str) -> str:
    if NOT_INSTALLED in differs:
        return f"No running worker has what it needs: {differs}. {PUT_BACK}, and it begins; or cancel it."
    return (
        f"It was submitted for a newer version than the running workers have: {differs}. Start a worker of the version "
        "of the service, and it begins; or cancel it."
    )


def _changed(differs: str) -> str:
    return f"{differs} since the run was submitted. {FILES_BACK}; or begin it again, with the simulator as it is now."


def _no_simulator(needs: str, live: int) -> str:
    without = "The running worker does not have it" if live == 1 else f"None of the {live} running workers has it"
    return (
        f"It needs the simulator {needs.partition('@')[0]} with the parameters and results that it had when the run "
        f"was submitted. {without}; put its files back as they were, or start a worker on a machine that has it."
    )


def _draining(able: int) -> str:
    who = "The only worker that can execute it was" if able == 1 else f"All {able} workers that can execute it were"
    return f"{who} asked to take no further run. Start another one with `clearance worker`."


def _short(able: int) -> str:
    who = "The worker that can execute it has" if able == 1 else f"All {able} workers that can execute it have"
    return f"{who} too little space left to begin a run ({VARIABLE}): an administrator must free space."


def _ago(seconds: float) -> str:
    for size, unit in ((86_400, "days"), (3_600, "hours"), (60, "min")):
        if seconds >= 2 * size:
            return f"{int(seconds // size)} {unit} ago"
    return "less than 2 min ago"
