"""Concurrency groups: a newer run of a group supersedes those that have not ended.

Group and successor of a run are rows of `run_labels` whose keys begin with @, which no label can: they are found by the
same index, and `backend.db.labels` leaves them out.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import sqlalchemy as sa

from backend.db import labels
from backend.db.tables import Run, RunLabel
from campaigns.runs import RunState, run_name

GROUP, SUCCESSOR = "@group", "@superseded"
LIVE = (RunState.QUEUED, RunState.RUNNING)
"""A run that is being cancelled already is superseded by none."""


def lock(writer: sa.Connection, group: str) -> None:
    """Two submissions of one group take turns; SQLite has one writer at a time anyway."""
    if writer.dialect.name == "postgresql":
        writer.execute(sa.select(sa.func.pg_advisory_xact_lock(sa.func.hashtext(f"clearance group {group}"))))


def store(writer: sa.Connection, run_id: int, group: str) -> None:
    writer.execute(sa.insert(RunLabel).values(run_id=run_id, key=GROUP, value=group))


def supersede(writer: sa.Connection, run_id: int, successor: int) -> None:
    """Store which run has superseded one; the first one stays."""
    known = sa.select(RunLabel.run_id).where(RunLabel.run_id == run_id, RunLabel.key == SUCCESSOR)
    if writer.scalar(known) is None:
        writer.execute(sa.insert(RunLabel).values(run_id=run_id, key=SUCCESSOR, value=run_name(successor)))


def active(reader: sa.Connection, group: str, run_id: int) -> list[tuple[int, str]]:
    """Number and owner of the other runs of a group that are queued or running, the oldest first."""
    of = sa.select(Run.id, Run.owner).join(RunLabel, RunLabel.run_id == Run.id)
    mine = (RunLabel.key == GROUP, RunLabel.value == group, Run.state.in_(LIVE), Run.id != run_id)
    return [(row.id, row.owner) for row in reader.execute(of.where(*mine).order_by(Run.id))]


class Labelled(NamedTuple):
    """What the rows of a run in `run_labels` have for the fields of its summary."""

    labels: dict[str, str]
    group: str | None
    superseded_by: str | None


def of_runs(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, Labelled]:
    """Labels, group and successor of each of these runs."""
    rows = labels.stored(reader, run_ids)
    found = {run_id: rows.get(run_id, {}) for run_id in run_ids}
    return {run_id: Labelled(own, own.pop(GROUP, None), own.pop(SUCCESSOR, None)) for run_id, own in found.items()}


def superseded(reader: sa.Connection, run_id: int) -> list[int]:
    """The runs that a run has superseded, the oldest first."""
    of = sa.select(RunLabel.run_id).where(RunLabel.key == SUCCESSOR, RunLabel.value == run_name(run_id))
    return list(reader.scalars(of.order_by(RunLabel.run_id)))
