"""Detects changes in the database since the last poll: runs, and the stages and improvements of watched runs.

On SQLite, `PRAGMA data_version` shows whether another connection has committed (sqlite.org/pragma.html); if not,
nothing is read. Not thread-safe.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

import sqlalchemy as sa

from backend.catalog.service import bounds, described
from backend.db.engine import is_sqlite, now, read
from backend.db.tables import Run
from backend.http.errors import RefusedError
from backend.http.schema import Schema
from backend.results.evaluations import Bounds, in_units
from backend.results.improvements import Improvements
from backend.runs import listing, service
from backend.runs.schemas import RunSummary, StageProgress
from campaigns.runs import ACTIVE, run_name

LATE = 10.0
"""Runs that ended this long before a mark are reported again: a commit becomes visible later than its timestamp [s]."""

MOST_ENDED = 500
"""Maximum number of ended runs reported after reconnecting; beyond it the client reloads the list."""


@dataclass(frozen=True)
class Event:
    """One event for the listeners of a run, and a run's summary for those of all runs."""

    run_id: int | None
    """None: for every listener."""
    name: str
    data: str

    def text(self, mark: str = "") -> str:
        """The wire format (WHATWG HTML, section 9.2); the client sends `mark` when it reconnects."""
        return f"event: {self.name}\ndata: {self.data}\n{identified(mark)}\n"


def identified(mark: str) -> str:
    """The `id` line of a mark; empty if there is no mark."""
    return f"id: {mark}\n" if mark else ""


@dataclass
class _Watched:
    paths: list[str] = field(default_factory=list)
    bounds: Bounds = field(default_factory=dict)
    stages: list[StageProgress] = field(default_factory=list)
    steps: dict[int, Improvements] = field(default_factory=dict)

    def since(self, steps: Improvements, known: int) -> NewImprovements:
        last = {}
        if steps.point is not None and len(steps.index) > known:
            last = in_units(steps.point[None], self.paths, self.bounds)
        return NewImprovements(
            index=steps.index[known:],
            seconds=steps.seconds[known:],
            cost=steps.cost[known:],
            evaluations=steps.read,
            elapsed=steps.elapsed,
            parameters={path: values[0] for path, values in last.items()},
        )


class Watch:
    def __init__(self, engine: sa.Engine) -> None:
        self._engine, self._isolated = engine, Isolated()
        self._raw: Any = None
        self._version: int | None = None
        self._seen: dict[int, RunSummary] = {}
        self._newest: int | None = None
        self._watched: dict[int, _Watched] = {}
        self.at = 0.0
        """Time by the queue's clock up to which everything has been reported: that of the last poll that read."""

    def close(self) -> None:
        if self._raw is not None:
            self._raw.close()
            self._raw = self._version = None

    def look(self, runs: Iterable[int], moved: bool = False) -> list[Event]:
        """Changes since the last poll: summaries of all runs, stages and improvements of the given ones.

        moved: the workers have changed, which may change what queued runs wait for although nothing was committed.
        """
        wanted = set(runs)
        new = wanted - self._watched.keys()
        if not self._committed() and not moved and not new and wanted == self._watched.keys():
            return []
        with read(self._engine) as reader:
            self.at = now(reader)
            self._watched = {i: self._watched.get(i) or _Watched() for i in wanted}
            events = self._runs(reader, wanted)
            for run_id, watched in self._watched.items():
                events += self._isolated.made(run_name(run_id), partial(_stages, reader, run_id, watched))
                events += self._isolated.made(run_name(run_id), partial(_improvements, reader, run_id, watched))
        return events

    def everything(self, run_id: int | None) -> list[Event]:
        """The first events of a new listener: its run in the last known state, or every active run."""
        if run_id is None:
            return [Event(i, "run", s.model_dump_json()) for i, s in self._seen.items() if s.state in ACTIVE]
        events = [Event(run_id, "run", self._seen[run_id].model_dump_json())] if run_id in self._seen else []
        watched = self._watched.get(run_id)
        if watched is None:
            return events
        steps = {str(position): watched.since(steps, 0).model_dump() for position, steps in watched.steps.items()}
        return [*events, _stage_event(run_id, watched.stages), Event(run_id, "evaluations", json.dumps(steps))]

    def ended(self, since: float) -> list[Event]:
        """The newest `MOST_ENDED` runs that ended since then [s since 1970], for a reconnecting listener."""
        over = sa.select(Run.id).where(Run.finished >= min(since, self.at) - LATE, Run.state.not_in(ACTIVE))
        with read(self._engine) as reader:
            found = self._summaries(reader, over.order_by(Run.finished.desc(), Run.id.desc()).limit(MOST_ENDED))
        return [Event(service.number(s.id), "run", s.model_dump_json()) for s in found]

    def _summaries(self, reader: sa.Connection, wanted: sa.Select[int]) -> list[RunSummary]:
        """The summaries of the wanted runs, read one by one if one of them cannot be read."""
        ids = reader.scalars(wanted).all()
        try:
            return listing.summaries(reader, Run.id.in_(ids))
        except sa.exc.SQLAlchemyError:
            raise
        except Exception:
            alone = ((i, partial(listing.summaries, reader, Run.id == i)) for i in ids)
            return [summary for i, make in alone for summary in self._isolated.made(run_name(i), make)]

    def _committed(self) -> bool:
        if not is_sqlite(self._engine):
            return True
        if self._raw is None:
            self._raw = self._engine.raw_connection()
        version = int(self._raw.driver_connection.execute("PRAGMA data_version").fetchone()[0])
        changed, self._version = version != self._version, version
        return changed

    def _runs(self, reader: sa.Connection, wanted: set[int]) -> list[Event]:
        """Runs that are active or were at the last poll, new ones, and the watched ones."""
        if self._newest is None:
            self._newest = reader.scalar(sa.select(sa.func.max(Run.id))) or 0
        ids = wanted | self._seen.keys()
        # Read the numbers first, from narrow indices, so that the wide rows of other runs are not read.
        changing = sa.select(Run.id).where(sa.or_(Run.state.in_(ACTIVE), Run.id.in_(ids), Run.id > self._newest))
        found = {service.number(s.id): s for s in self._summaries(reader, changing)}
        events = [
            Event(run_id, "run", summary.model_dump_json())
            for run_id, summary in found.items()
            if self._seen.get(run_id) != summary
        ]
        self._seen = {i: s for i, s in found.items() if s.state in ACTIVE or i in wanted}
        self._newest = max([self._newest, *found])
        return events


def _parameters(reader: sa.Connection, run_id: int) -> tuple[list[str], Bounds]:
    try:
        campaign = service.campaign(reader, run_id)
        return list(campaign.uncertain), bounds(campaign, described(reader, run_id))
    except RefusedError:  # its progress is reported nevertheless
        return [], {}


def _stages(reader: sa.Connection, run_id: int, watched: _Watched) -> list[Event]:
    stages = service.progress(reader, run_id)
    if stages == watched.stages:
        return []
    watched.stages = stages
    return [_stage_event(run_id, stages)]


def _improvements(reader: sa.Connection, run_id: int, watched: _Watched) -> list[Event]:
    known, added = watched.steps, {}
    watched.steps = {s.position: known.get(s.position, Improvements()).of(s.started) for s in watched.stages}
    if any(steps is not known.get(position) for position, steps in watched.steps.items()):
        # The worker that begins a run stores its own component descriptions.
        watched.paths, watched.bounds = _parameters(reader, run_id)
    for stage in watched.stages:
        steps = watched.steps[stage.position]
        if stage.stored <= steps.read:
            continue
        before = len(steps.index)
        steps.catch_up(reader, run_id, stage.position)
        added[str(stage.position)] = watched.since(steps, before).model_dump()
    return [Event(run_id, "evaluations", json.dumps(added))] if added else []


def _stage_event(run_id: int, stages: list[StageProgress]) -> Event:
    return Event(run_id, "stages", json.dumps([stage.model_dump() for stage in stages]))


class NewImprovements(Schema):
    """Improvements of one stage, as columns of equal length, to be appended by index to those already received.

    If the stage's `started` in the last `stages` event differs from before, the run began again: what was received is
    discarded.
    The first event after connecting has all of them, later ones only the new ones.
    """

    index: list[int]
    seconds: list[float]
    cost: list[float]
    evaluations: int
    """The total number of evaluations of the stage."""
    elapsed: float
    """Working time of the stage at the last of them [s]."""
    parameters: dict[str, float]
    """The parameters of the last of these improvements, {path: value} in their units; empty if there is none."""


Part = TypeVar("Part")

_log = logging.getLogger(__name__)


class Isolated:
    """Makes parts, each in the log once if it cannot be made; an error of the database concerns them all."""

    def __init__(self) -> None:
        self._logged: set[str] = set()

    def made(self, what: str, make: Callable[[], list[Part]]) -> list[Part]:
        """This part; empty if it cannot be made."""
        try:
            return make()
        except sa.exc.SQLAlchemyError:
            raise
        except Exception:
            if what not in self._logged:
                self._logged.add(what)
                _log.exception("%s cannot be reported in the event streams", what)
            return []
