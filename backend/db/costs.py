"""What an evaluation of a simulator took, as runs or `clearance check-simulator` measured it."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import workers
from backend.db.engine import insert, now
from backend.db.tables import Run, SimulatorMeasurement, Stage
from campaigns.asked.proposal import Cost
from campaigns.catalogue import SimulatorEntry
from campaigns.results.measured import Measured
from campaigns.runs import StageState, run_name
from campaigns.stages.found import stage_result
from campaigns.versions import Versions

RECENT = 50
"""Number of recent runs or checks of the simulator among which the newest measurement is searched."""


@dataclass(frozen=True)
class _Measurement:
    at: float
    digest: str | None
    """Of the simulator's files then; None if it was not recorded."""
    cost: Cost


def store(writer: sa.Connection, entry: SimulatorEntry, digest: str, measured: Measured) -> None:
    """Store what the command measured; it replaces the earlier measurement of the same declaration and files."""
    values = {
        "measured": now(writer),
        "host": socket.gethostname()[:120],
        "result": measured.model_dump(mode="json"),
    }
    row = insert(writer, SimulatorMeasurement).values(simulator=entry.version, digest=digest[:128], **values)
    key = [SimulatorMeasurement.simulator, SimulatorMeasurement.digest]
    writer.execute(row.on_conflict_do_update(index_elements=key, set_=values))


def newest(reader: sa.Connection, entry: SimulatorEntry, digest: str | None) -> tuple[Cost | None, Cost | None]:
    """The newest measurement of the simulator as it is now, and else the newest one of other files of it.

    digest: of its files as they were published; None if it is not known. A run that began after that has seen newer
    files; what `clearance check-simulator` has measured may be files of another folder, so that only its digest counts.
    """
    since = workers.published(reader) or 0.0
    found = [
        _first(_of_runs(reader, entry), digest, since),
        _first(_of_checks(reader, entry), digest, float("inf")),
    ]
    fitting = [fits for fits, _ in found if fits is not None]
    if fitting:
        return max(fitting, key=lambda one: one.at).cost, None
    others = [other for _, other in found if other is not None]
    return None, max(others, key=lambda one: one.at).cost if others else None


def _first(
    found: Iterator[_Measurement], digest: str | None, since: float
) -> tuple[_Measurement | None, _Measurement | None]:
    """The first one of these files or newer than `since`, and else the first one."""
    other = None
    for one in found:
        if digest is None or one.digest == digest or one.at > since:
            return one, None
        other = other or one
    return None, other


def _of_runs(reader: sa.Connection, entry: SimulatorEntry) -> Iterator[_Measurement]:
    """The measurements by runs of the simulator with this declaration, the newest first."""
    nominal = sa.and_(Stage.run_id == Run.id, Stage.position == 0, Stage.state == StageState.DONE)
    query = (
        sa.select(Run.id, Run.started, Run.flown, Stage.result)
        .join(Stage, nominal)
        .where(Run.needs.in_(entry.versions), Run.removed.is_(None))
        .order_by(Run.id.desc())
        .limit(RECENT)
    )
    for run_id, started, flown, result in reader.execute(query):
        measured = stage_result(result).repeatability
        cost = None if measured is None else _cost(measured, run_name(run_id), started)
        if cost is not None:
            yield _Measurement(started or 0.0, Versions.of(flown).simulator, cost)


def _of_checks(reader: sa.Connection, entry: SimulatorEntry) -> Iterator[_Measurement]:
    """The measurements by `clearance check-simulator` of the simulator with this declaration, the newest first."""
    table = SimulatorMeasurement
    query = sa.select(table.measured, table.host, table.digest, table.result)
    query = query.where(table.simulator.in_(entry.versions))
    for at, host, digest, result in reader.execute(query.order_by(table.measured.desc()).limit(RECENT)):
        with suppress(ValidationError):  # another version stored it
            cost = _cost(Measured.model_validate(result), None, at, host)
            if cost is not None:
                yield _Measurement(at, digest, cost)


def _cost(measured: Measured, run: str | None, at: float | None, host: str = "") -> Cost | None:
    if not (measured.call_seconds and measured.slots):
        return None
    return Cost(
        run,
        measured.call_seconds,
        measured.slots,
        measured.evaluations,
        measured.failed,
        at,
        host,
        start=measured.start_seconds or 0.0,
        recycle=measured.recycle or 0,
        noisy=not measured.repeats,
    )
