"""The metrics of a service: its queue and workers as the database has them, its requests, its space."""

from __future__ import annotations

from collections.abc import Iterator

import sqlalchemy as sa

from backend.db import space
from backend.db.engine import now, read
from backend.db.outages import DatabaseOutage
from backend.db.tables import Run, Worker
from backend.db.workers import STILL, recent, standing_still
from backend.metrics.requests import Requests
from backend.metrics.text import Metric, gauge, gauges
from backend.runs.filters import Filters
from backend.runs.listing import counted
from campaigns.runs import ACTIVE, RunState


class Metrics:
    """Reads the metrics."""

    def __init__(self, room: space.Room, requests: Requests) -> None:
        self.room, self.requests = room, requests

    def text(self, engine: sa.Engine, waiting: dict[str, int]) -> str:
        """waiting: the length of each queue of this process. A database that cannot be used is a metric, too."""
        try:
            stored = _of_the_database(engine)
        except DatabaseOutage:
            stored = None
        return "".join(metric.text() for metric in self._metrics(stored, waiting))

    def _metrics(self, stored: list[Metric] | None, waiting: dict[str, int]) -> Iterator[Metric]:
        yield gauge("clearance_database_up", "1 if the database can be used.", float(stored is not None))
        yield from stored or ()
        yield gauges("clearance_jobs", "Running and waiting jobs of the service.", "queue", waiting)
        yield gauge("clearance_free_bytes", "Least free space where data is written.", self.room.free())
        yield Metric(
            "clearance_request_seconds", "histogram", "Requests by route and status class.", self.requests.samples()
        )


def _of_the_database(engine: sa.Engine) -> list[Metric]:
    with read(engine) as reader:
        at, states = now(reader), counted(reader, Filters())
        evaluations = reader.scalar(sa.select(sa.func.sum(Run.evaluations)).where(Run.purged.is_(None)))
        losses = reader.scalar(sa.select(sa.func.sum(Run.losses)).where(Run.state.in_(ACTIVE)))
        still = len(standing_still(reader))
        beats = reader.scalars(sa.select(Worker.beat)).all()
    alive = sum(recent(beat, at) for beat in beats)
    workers = {"alive": alive, "lost": len(beats) - alive}
    return [
        gauges("clearance_runs", "Listed runs by state.", "state", {state: states[state] for state in RunState}),
        gauge(
            "clearance_runs_standing_still",
            f"Runs that a worker has, without a new stored evaluation for {STILL:g} s.",
            still,
        ),
        gauge("clearance_evaluations", "Evaluations made, of runs that are not purged.", int(evaluations or 0)),
        gauges("clearance_workers", "Workers by their heartbeat; lost: silent within a day.", "state", workers),
        gauge("clearance_run_losses", "Workers that active runs have lost since their last result.", losses or 0),
    ]
