"""The run list: search, filters, sorting, and pages that stay stable while runs are added.

Filters are in `backend.runs.filters`, orders and cursors in `backend.runs.order`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sqlalchemy as sa

from backend.db import groups
from backend.db.engine import read
from backend.db.tables import CampaignRow, Run, Stage
from backend.runs import counts, earlier_rules, identity, policy, quantities, sample_kind, violations, waiting
from backend.runs.filters import Filters, unindexed
from backend.runs.order import VALUES, Order, Sort
from backend.runs.schemas import RunPage, RunSummary, StageProgress
from campaigns.results.verdict import VerdictWord
from campaigns.runs import HELD, RunState, StageState, run_name

_OF_CAMPAIGN = {f"campaign_{column.name}": column for column in CampaignRow.__table__.columns}
_COLUMNS = _OF_CAMPAIGN | VALUES | dict(Run.__table__.columns.items())
_PLAIN = tuple(name for name in RunSummary.model_fields if name in _COLUMNS and name not in counts.NAMES)
"""The fields of a summary that are columns of the run or of its campaign, or values by which the list is sorted."""

_SUMMARIES = (
    sa.select(
        *(_COLUMNS[name].label(name) for name in _PLAIN),
        *quantities.COLUMNS,
        *counts.COLUMNS,
        *identity.COLUMNS,
        *sample_kind.COLUMNS,
        *policy.COLUMNS,
        earlier_rules.COLUMN,
    )
    .join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    .where(Run.purged.is_(None))
    .order_by(Run.id.desc())
)
"""What a summary is made of; built once, because that takes longer than reading a row."""


def page(
    reader: sa.Connection, filters: Filters, sort: Sort, cursor: str | None, limit: int, pins: bool = True
) -> RunPage:
    """One page of the list, the cursor of the next page, and the total counts for the same search. pins: pinned runs
    come first."""
    order, conditions = Order(sort, pins), filters.conditions()
    if cursor is not None:
        conditions.append(order.after(cursor))
    keys = sa.select(Run.id, Run.pinned, order.value.label("value")).where(*conditions)
    rows = reader.execute(keys.order_by(*order.columns).limit(limit + 1)).all()
    ids = [row.id for row in rows[:limit]]
    by_id = {item.id: item for item in summaries(reader, Run.id.in_(ids))}
    following = order.cursor(rows[limit - 1]) if len(rows) > limit else None
    return RunPage(items=[by_id[run_name(i)] for i in ids], next_cursor=following, counts=counted(reader, filters))


def named(engine: sa.Engine, run_ids: Sequence[int]) -> list[RunSummary]:
    """The summaries of these runs, in this order."""
    with read(engine) as reader:
        found = {item.id: item for item in summaries(reader, Run.id.in_(run_ids))}
    return [found[run_name(run_id)] for run_id in dict.fromkeys(run_ids)]


def summaries(reader: sa.Connection, *conditions: sa.ColumnElement[bool]) -> list[RunSummary]:
    """Summaries of the runs that fulfil the conditions, newest first; purged runs are omitted."""
    rows = reader.execute(_SUMMARIES.where(*conditions)).all()
    working = _working(reader, [row.id for row in rows if row.state in HELD])
    described = quantities.installed(reader, rows)
    excluded = counts.excluded(reader, [row.id for row in rows])
    labelled = groups.of_runs(reader, [row.id for row in rows])
    waits = waiting.reasons(reader, [row.id for row in rows if row.state == RunState.QUEUED])
    contradicted = violations.sentences(reader, [row.id for row in rows])
    doing = waiting.doing(reader, [row.id for row in rows if row.state == RunState.RUNNING])
    return [
        _summary(
            row,
            counts.of(row, excluded.get(row.id, 0))
            | {"stage": working.get(row.id), "doing": doing.get(row.id), "against": contradicted.get(row.id, "")}
            | waits.get(row.id, waiting.Waits(None))._asdict()
            | labelled[row.id]._asdict()
            | quantities.of(row, described)._asdict(),
        )
        for row in rows
    ]


def _summary(row: Any, others: dict[str, Any]) -> RunSummary:
    """others: the fields that are not of the run's own row."""
    values = dict(zip(_PLAIN, row, strict=False)) | others
    own, code = identity.with_digest(row)
    values |= {"code": code, "unidentified": list(own.unidentified) if own else []}
    values |= sample_kind.of(row)._asdict()
    values |= {"policy": policy.of(row), "earlier_rules": earlier_rules.of(row)}
    values |= {"id": run_name(row.id), "continues": None if row.continues is None else run_name(row.continues)}
    return RunSummary.model_validate(values)


def _working(reader: sa.Connection, ids: list[int]) -> dict[int, StageProgress]:
    if not ids:
        return {}
    columns = counts.columns(StageProgress)
    running = (Stage.run_id.in_(ids), Stage.state == StageState.RUNNING)
    rows = reader.execute(sa.select(Stage.run_id, *columns).where(*running))
    return {
        row.run_id: StageProgress.model_validate({k: v for k, v in row._mapping.items() if k != "run_id"})
        for row in rows
    }


def counted(reader: sa.Connection, filters: Filters) -> dict[str, int]:
    """The numbers of runs by state and by verdict for the same search, those removed apart."""
    narrowed, there = filters.narrowed, filters.there()
    counts = dict.fromkeys(("total", "removed", *RunState, *VerdictWord), 0)
    whole = not (narrowed or filters.removed)  # these counts have an index of their own
    columns: list[Any] = [column if whole else unindexed(column) for column in (Run.state, Run.verdict)]
    query = sa.select(*columns, sa.func.count()).where(*there, *narrowed).group_by(*columns)
    query = query.where(Run.state.is_not(None)) if whole else query
    for row in reader.execute(query):
        state, verdict, count = tuple(row)
        counts["total"] += count
        counts[state] += count
        if verdict:
            counts[verdict] += count
    away = [*filters.there(removed=True), *narrowed]
    counts["removed"] = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(*away)) or 0
    return counts
