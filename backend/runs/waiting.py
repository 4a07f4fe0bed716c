"""Why a queued run has not started. Start reading at `reason`."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import Run, Worker
from backend.db.workers import LIVE


def reason(reader: sa.Connection, run_id: int) -> str | None:
    """One sentence; None if the run is not queued."""
    asked = sa.select(Run.state, Run.needs, Run.not_before).where(Run.id == run_id)
    row = reader.execute(asked).one_or_none()
    if row is None or row.state != "queued":
        return None
    at = now(reader)
    workers = reader.execute(sa.select(Worker.beat, Worker.run_id, Worker.simulators)).all()
    live = [worker for worker in workers if worker.beat > at - LIVE]
    if not live:
        return _no_worker(max((worker.beat for worker in workers), default=None), at)
    able = [worker for worker in live if row.needs is None or row.needs in worker.simulators]
    if not able:
        return _no_simulator(row.needs or "", len(live))
    if row.not_before > at:
        return f"It is tried again in {max(1, round(row.not_before - at))} s."
    if all(worker.run_id is not None for worker in able):
        busy = "The only worker that can execute it is busy" if len(able) == 1 else f"All {len(able)} workers are busy"
        return f"{busy}; it starts automatically when one is free."
    return "It starts automatically within a few seconds."


def _no_worker(last: float | None, at: float) -> str:
    seen = "" if last is None else f"; the last one was seen {_ago(at - last)} ago"
    return f"No worker is running{seen}. Start one with `clearance worker`."


def _no_simulator(needs: str, live: int) -> str:
    without = "The running worker does not have it" if live == 1 else f"None of the {live} running workers has it"
    return (
        f"It needs the simulator {needs.partition('@')[0]} with the parameters and results that it had when the run "
        f"was submitted. {without}; start a worker on a machine that has it."
    )


def _ago(seconds: float) -> str:
    for size, unit in ((86_400, "days"), (3_600, "hours"), (60, "min")):
        if seconds >= 2 * size:
            return f"{int(seconds // size)} {unit}"
    return f"{int(seconds)} s"
