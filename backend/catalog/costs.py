"""What an evaluation of a simulator took in the newest run of it. Start reading at `newest`."""

from __future__ import annotations

from collections.abc import Iterator

import sqlalchemy as sa

from backend.db import workers
from backend.db.tables import Run, Stage
from campaigns.asked.proposal import Cost
from campaigns.catalogue import SimulatorEntry
from campaigns.results import NominalResult
from campaigns.runs import run_name
from campaigns.versions import Versions

RECENT_RUNS = 50
"""Number of recent runs of the simulator among which the newest measurement is searched."""


def newest(reader: sa.Connection, entry: SimulatorEntry, digest: str | None) -> tuple[Cost | None, Cost | None]:
    """What the newest run of the simulator as it is now measured, and else what one of other files of it did.

    A run that began after the digest was published has seen newer files than that.
    """
    since = workers.published(reader) or 0.0
    other = None
    for started, flown, cost in _measured(reader, entry):
        if digest is None or flown.simulator == digest or started > since:
            return cost, None
        other = other or cost
    return None, other


def _measured(reader: sa.Connection, entry: SimulatorEntry) -> Iterator[tuple[float, Versions, Cost]]:
    """The measurements by runs of the simulator with this declaration, the newest first: start, versions, cost."""
    nominal = sa.and_(Stage.run_id == Run.id, Stage.kind == "nominal", Stage.state == "done")
    asked = (
        sa.select(Run.id, Run.started, Run.flown, Stage.result)
        .join(Stage, nominal)
        .where(Run.needs == entry.version, Run.removed.is_(None))
        .order_by(Run.id.desc())
        .limit(RECENT_RUNS)
    )
    for run_id, started, flown, result in reader.execute(asked):
        measured = NominalResult.model_validate(result).measured
        if measured is not None and measured.call_seconds and measured.slots:
            counts = (measured.call_seconds, measured.slots, measured.evaluations, measured.failed)
            yield started or 0.0, Versions.of(flown), Cost(run_name(run_id), *counts)
