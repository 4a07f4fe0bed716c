"""The workers of this database by their heartbeats."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.space import Room
from backend.db.tables import Run, Stage, Worker
from backend.db.workers import Doing, beating, last_seen, recent, standing_still
from backend.runs import waiting
from backend.workers.schemas import Space, Still, WorkerOut, Workers
from campaigns.runs import RunState, StageState, run_name
from campaigns.stages.found import declared

LISTED = 600.0
"""A worker without a heartbeat is listed for this long [s]; one that stops in an orderly way is not."""


def workers(reader: sa.Connection, room: Room) -> Workers:
    """The live workers, those that have become silent recently, when one was last seen, and the space left."""
    at = now(reader)
    listed = sa.select(Worker.__table__).where(beating(at, LISTED)).order_by(Worker.started, Worker.name)
    rows = reader.execute(listed).all()
    stages = _stages(reader, [row.run_id for row in rows if row.run_id is not None])
    items = [_out(row, at, stages) for row in rows]
    queued = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(Run.state == RunState.QUEUED))
    return Workers(
        now=at,
        alive=sum(item.state != "silent" for item in items),
        last_seen=last_seen(reader),
        queued=queued or 0,
        still=[Still(run=run_name(run_id), since=since) for run_id, since in standing_still(reader).items()],
        space=Space(free=room.free(), limit=room.limit, short=room.short()),
        items=items,
    )


def _out(row: Any, at: float, stages: dict[int, str]) -> WorkerOut:
    silent = not recent(row.beat, at)
    known = None if silent else Doing.of(row.doing, row.run_id)
    same = ("name", "host", "pid", "started", "beat", "draining", "short")
    return WorkerOut(
        **{name: getattr(row, name) for name in same},
        state="silent" if silent else "idle" if row.run_id is None else "busy",
        run=None if row.run_id is None else run_name(row.run_id),
        stage=None if silent or row.run_id is None else stages.get(row.run_id),
        doing=None if known is None else waiting.doing_of(known),
        simulators=sorted({version.partition("@")[0] for version in row.simulators}),
    )


def _stages(reader: sa.Connection, run_ids: list[int]) -> dict[int, str]:
    if not run_ids:
        return {}
    running = sa.select(Stage.run_id, Stage.kind, Stage.method).where(
        Stage.run_id.in_(run_ids), Stage.state == StageState.RUNNING
    )
    found = {}
    for row in reader.execute(running.order_by(Stage.position.desc())):
        kind = declared().get(row.kind)
        title = row.kind.capitalize() if kind is None else kind.title
        found[row.run_id] = f"{title}, {row.method}" if row.method else title
    return found
