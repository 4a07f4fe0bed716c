"""What changed in the database since the last look: runs, and the stages and improvements of watched runs.

SQLite says by `PRAGMA data_version` that nothing was committed elsewhere (sqlite.org/pragma.html), and then nothing is
read. Not for use by two threads at once. Start reading at `Watch.look`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sqlalchemy as sa

from backend.db.engine import is_sqlite, read
from backend.db.tables import EvaluationChunk, Run
from backend.events.schemas import NewImprovements
from backend.results import thin
from backend.runs import listing, service
from backend.runs.schemas import RunSummary, StageProgress

ACTIVE = ("queued", "running", "cancelling")


@dataclass(frozen=True)
class Event:
    """One event for the listeners of a run, and a run's summary for those of all runs."""

    run_id: int
    name: str
    data: str

    def text(self) -> str:
        """As it goes over the wire (WHATWG HTML, section 9.2)."""
        return f"event: {self.name}\ndata: {self.data}\n\n"


@dataclass
class _Steps:
    """The improvements of one stage so far."""

    index: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    cost: list[float] = field(default_factory=list)
    read: int = 0
    elapsed: float = 0.0

    def since(self, known: int) -> dict[str, Any]:
        return NewImprovements(
            index=self.index[known:],
            seconds=self.seconds[known:],
            cost=self.cost[known:],
            evaluations=self.read,
            elapsed=self.elapsed,
        ).model_dump()

    def add(self, chunk: Any) -> None:
        costs = np.frombuffer(chunk.costs, dtype="<f8").reshape(chunk.count, -1)[:, 0]
        costs = np.where(np.frombuffer(chunk.status, dtype=np.uint8) == 0, costs, np.nan)
        seconds = np.frombuffer(chunk.seconds, dtype="<f8")
        better = thin.improvements(costs, self.cost[-1] if self.cost else np.inf)
        self.index += (chunk.first + better).tolist()
        self.seconds += seconds[better].tolist()
        self.cost += costs[better].tolist()
        self.read, self.elapsed = chunk.first + chunk.count, float(seconds[-1])


@dataclass
class _Watched:
    """A run with listeners of its own."""

    stages: list[StageProgress] = field(default_factory=list)
    steps: dict[int, _Steps] = field(default_factory=dict)


class Watch:
    """Remembers what it saw last."""

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine
        self._raw: Any = None
        self._version: int | None = None
        self._seen: dict[int, RunSummary] = {}
        self._newest: int | None = None
        self._watched: dict[int, _Watched] = {}

    def close(self) -> None:
        """Give the connection back."""
        if self._raw is not None:
            self._raw.close()
            self._raw = None

    def look(self, runs: Iterable[int]) -> list[Event]:
        """What changed since the last look: summaries of all runs, stages and improvements of the given ones."""
        wanted = set(runs)
        new = wanted - self._watched.keys()
        if not self._committed() and not new and wanted == self._watched.keys():
            return []
        self._watched = {run_id: self._watched.get(run_id, _Watched()) for run_id in wanted}
        with read(self._engine) as reader:
            events = self._runs(reader, wanted)
            for run_id, watched in self._watched.items():
                events += _stages(reader, run_id, watched)
                events += _improvements(reader, run_id, watched)
        return events

    def everything(self, run_id: int | None) -> list[Event]:
        """What a new listener is told first: its run as last seen, or every run that is not over."""
        if run_id is None:
            return [_event(i, "run", s.model_dump_json()) for i, s in self._seen.items() if s.state in ACTIVE]
        events = [_event(run_id, "run", self._seen[run_id].model_dump_json())] if run_id in self._seen else []
        watched = self._watched.get(run_id)
        if watched is None:
            return events
        steps = {str(position): steps.since(0) for position, steps in watched.steps.items()}
        return [*events, _stage_event(run_id, watched.stages), _event(run_id, "evaluations", json.dumps(steps))]

    def _committed(self) -> bool:
        """Whether anything may have been committed since the last time this was asked."""
        if not is_sqlite(self._engine):
            return True
        if self._raw is None:
            self._raw = self._engine.raw_connection()
        version = int(self._raw.driver_connection.execute("PRAGMA data_version").fetchone()[0])
        changed, self._version = version != self._version, version
        return changed

    def _runs(self, reader: sa.Connection, wanted: set[int]) -> list[Event]:
        """Runs that are not over or were not at the last look, new ones, and the watched ones."""
        if self._newest is None:
            self._newest = reader.scalar(sa.select(sa.func.max(Run.id))) or 0
        ids = wanted | self._seen.keys()
        changing = sa.or_(Run.state.in_(ACTIVE), Run.id.in_(ids), Run.id > self._newest)
        found = {service.number(s.id): s for s in listing.summaries(reader, changing)}
        events = [
            _event(run_id, "run", summary.model_dump_json())
            for run_id, summary in found.items()
            if self._seen.get(run_id) != summary
        ]
        self._seen = {i: s for i, s in found.items() if s.state in ACTIVE or i in wanted}
        self._newest = max([self._newest, *found])
        return events


def _stages(reader: sa.Connection, run_id: int, watched: _Watched) -> list[Event]:
    stages = service.progress(reader, run_id)
    if stages == watched.stages:
        return []
    watched.stages = stages
    return [_stage_event(run_id, stages)]


def _improvements(reader: sa.Connection, run_id: int, watched: _Watched) -> list[Event]:
    added = {}
    for stage in watched.stages:
        steps = watched.steps.setdefault(stage.position, _Steps())
        if stage.evaluations <= steps.read:
            continue
        known = len(steps.index)
        for chunk in _chunks(reader, run_id, stage.position, steps.read):
            steps.add(chunk)
        added[str(stage.position)] = steps.since(known)
    return [_event(run_id, "evaluations", json.dumps(added))] if added else []


def _chunks(reader: sa.Connection, run_id: int, position: int, first: int) -> Iterable[Any]:
    chunk = EvaluationChunk
    query = sa.select(chunk.first, chunk.count, chunk.costs, chunk.status, chunk.seconds)
    of = (chunk.run_id == run_id, chunk.position == position, chunk.first >= first)
    return reader.execute(query.where(*of).order_by(chunk.first)).all()


def _stage_event(run_id: int, stages: list[StageProgress]) -> Event:
    return _event(run_id, "stages", json.dumps([stage.model_dump() for stage in stages]))


def _event(run_id: int, name: str, data: str) -> Event:
    return Event(run_id, name, data)
