"""What is stated of a run that has lost its worker, or has failed after its last attempt."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.outages import storable
from backend.db.tables import Stage
from campaigns.runs import StageState

MOST_LOSSES = 10
"""Workers in a row that a run may lose without a new evaluation: a fault of its own may look like this, as when the
system kills what takes too much memory."""

SILENT = "its worker stopped sending heartbeats"
ATTEMPTS = ("attempts", "last attempt")
LOSSES = ("lost workers without a new evaluation", "the last one")


def lost(losses: int, how: str) -> str:
    return storable(f"Worker {losses} of {MOST_LOSSES} lost without a new evaluation: {how}.")


def failed_after(connection: sa.Connection, run_id: int, count: int, how: str, what: tuple[str, str] = ATTEMPTS) -> str:
    running = sa.select(Stage.kind, Stage.method).where(Stage.run_id == run_id, Stage.state == StageState.RUNNING)
    stage = connection.execute(running.order_by(Stage.position)).first()
    where = "before its first stage"
    if stage is not None:
        where = f"in the {stage.kind} stage" + (f" ({stage.method})" if stage.method else "")
    return f"Failed after {count} {what[0]} {where}; {what[1]}: {how}."
