"""The labels of runs, for the queue, the run list and the search of a baseline."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import sqlalchemy as sa

from backend.db.tables import Run, RunLabel

GIVEN = RunLabel.key.not_like("@%")
"""Labels that users gave; the other rows are those of `backend.db.groups`."""


def store(writer: sa.Connection, run_id: int, labels: Mapping[str, str]) -> None:
    if labels:
        rows = [{"run_id": run_id, "key": key, "value": value} for key, value in labels.items()]
        writer.execute(sa.insert(RunLabel), rows)


def of_runs(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, dict[str, str]]:
    """The labels of these runs by key, in alphabetical order; runs without any are omitted."""
    return stored(reader, run_ids, GIVEN)


def stored(
    reader: sa.Connection, run_ids: Collection[int], *which: sa.ColumnElement[bool]
) -> dict[int, dict[str, str]]:
    """The labels of these runs that fulfil the conditions, as values by key."""
    found: dict[int, dict[str, str]] = {}
    if run_ids:
        rows = sa.select(RunLabel.run_id, RunLabel.key, RunLabel.value).where(RunLabel.run_id.in_(run_ids), *which)
        for run_id, key, value in reader.execute(rows.order_by(RunLabel.key)):
            found.setdefault(run_id, {})[key] = value
    return found


def conditions(pairs: Sequence[tuple[str, str]]) -> list[sa.ColumnElement[bool]]:
    """Runs with these labels: several values of one key are alternatives."""
    wanted: dict[str, list[str]] = {}
    for key, value in pairs:
        wanted.setdefault(key, []).append(value)
    return [
        Run.id.in_(sa.select(RunLabel.run_id).where(RunLabel.key == key, RunLabel.value.in_(values)))
        for key, values in wanted.items()
    ]
