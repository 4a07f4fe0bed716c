"""The run list: search, filter, sort, and pages that hold their place while runs come in.

Pages go by key, not by offset (Winand, "Paging Through Results", use-the-index-luke.com): a cursor names the last row's
sort value and number. Start reading at `page`.
"""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run, Stage
from backend.errors import RefusedError
from backend.runs.schemas import RunPage, RunState, RunSummary, StageProgress, VerdictWord
from campaigns import Problem

Sort = Literal[
    "created", "-created", "started", "-started", "finished", "-finished", "name", "-name",
    "state", "-state", "verdict", "-verdict", "margin", "-margin", "worst", "-worst", "evaluations", "-evaluations",
]  # fmt: skip

_SORTS: dict[str, sa.ColumnElement[Any]] = {
    "created": sa.type_coerce(Run.id, sa.Integer),  # runs are numbered as they are created
    "started": sa.type_coerce(Run.started, sa.Double),
    "finished": sa.type_coerce(Run.finished, sa.Double),
    "name": sa.type_coerce(sa.func.lower(Run.name), sa.String),
    "state": sa.type_coerce(Run.state, sa.String),
    "verdict": sa.type_coerce(Run.verdict, sa.String),
    "margin": Run.worst_cost - Run.threshold,
    "worst": sa.type_coerce(Run.worst_cost, sa.Double),
    "evaluations": sa.type_coerce(Run.evaluations, sa.Integer),
}
_PLAIN = (
    "id", "name", "tags", "owner", "state", "verdict", "reason", "error", "campaign_digest", "threshold",
    "nominal_cost", "worst_cost", "worst_method", "evaluations", "planned", "failed_evaluations", "created", "started",
    "finished", "attempts", "worker", "continues",
)  # fmt: skip


@dataclass(frozen=True)
class Filters:
    """What the list is narrowed to; lists are alternatives, an empty one is no condition."""

    q: str = ""
    state: Sequence[RunState] = ()
    verdict: Sequence[VerdictWord] = ()
    tag: Sequence[str] = ()


def name(run_id: int) -> str:
    """R-0001 of 1."""
    return f"R-{run_id:04d}"


def page(reader: sa.Connection, filters: Filters, sort: Sort, cursor: str | None, limit: int) -> RunPage:
    """One page of the list, the cursor of the next, and how many runs the same search and tags find in all."""
    found = _found(filters)
    conditions = list(found)
    if filters.state:
        conditions.append(Run.state.in_(filters.state))
    if filters.verdict:
        conditions.append(Run.verdict.in_(filters.verdict))
    if cursor is not None:
        conditions.append(_after(sort, *_decode(cursor, sort)))
    value = _SORTS[sort.lstrip("-")]
    keys = sa.select(Run.id, value.label("value")).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    rows = reader.execute(keys.where(*conditions).order_by(*_order(sort)).limit(limit + 1)).all()
    ids = [row.id for row in rows[:limit]]
    by_id = {item.id: item for item in summaries(reader, Run.id.in_(ids))}
    following = _encode(sort, rows[limit - 1].value, rows[limit - 1].id) if len(rows) > limit else None
    return RunPage(items=[by_id[name(i)] for i in ids], next_cursor=following, counts=_counts(reader, found))


def summaries(reader: sa.Connection, *conditions: sa.ColumnElement[bool]) -> list[RunSummary]:
    """The runs that fulfil the conditions, newest first, as the list shows them."""
    criterion = CampaignRow.document["criterion"]["component"].as_string().label("criterion")
    told = [Run.summary[key].as_string().label(key) for key in ("quantity", "unit")]
    columns = [getattr(Run, column) for column in _PLAIN]
    query = sa.select(*columns, CampaignRow.name.label("campaign_name"), criterion, *told)
    query = query.join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    rows = reader.execute(query.where(*conditions).order_by(Run.id.desc())).all()
    working = _working(reader, [row.id for row in rows if row.state in ("running", "cancelling")])
    units = _units(reader) if any(row.unit is None for row in rows) else {}
    return [_summary(row, working.get(row.id), units) for row in rows]


def _summary(row: Any, stage: StageProgress | None, units: dict[str, tuple[str, str]]) -> RunSummary:
    values = {column: getattr(row, column) for column in _PLAIN}
    quantity, unit = units.get(row.criterion, ("", ""))
    margin = None if row.worst_cost is None or row.threshold is None else row.worst_cost - row.threshold
    values["continues"] = None if row.continues is None else name(row.continues)
    values |= {"id": name(row.id), "campaign_name": row.campaign_name, "stage": stage, "margin": margin}
    values |= {"quantity": row.quantity or quantity, "unit": unit if row.unit is None else row.unit}
    return RunSummary.model_validate(values)


def _units(reader: sa.Connection) -> dict[str, tuple[str, str]]:
    """Quantity and unit by criterion, for runs that have no verdict to say it."""
    catalogue = published(reader)
    found = [] if catalogue is None else catalogue.components
    return {c.name: (c.quantity, c.unit) for c in found if c.role == "criterion"}


def _working(reader: sa.Connection, ids: list[int]) -> dict[int, StageProgress]:
    """The stage in work of each of the runs."""
    if not ids:
        return {}
    columns = [getattr(Stage, field) for field in StageProgress.model_fields]
    rows = reader.execute(sa.select(Stage.run_id, *columns).where(Stage.run_id.in_(ids), Stage.state == "running"))
    return {
        row.run_id: StageProgress.model_validate({k: v for k, v in row._mapping.items() if k != "run_id"})
        for row in rows
    }


def _found(filters: Filters) -> list[sa.ColumnElement[bool]]:
    """The conditions of search text and tags: every word is in a name, a tag, the owner or the number."""
    tags = sa.cast(Run.tags, sa.Text)
    conditions: list[sa.ColumnElement[bool]] = []
    for word in filters.q.split()[:8]:
        columns = [Run.name, CampaignRow.name, Run.owner, tags, _printed_id()]
        conditions.append(sa.or_(*(column.icontains(word, autoescape=True) for column in columns)))
    if filters.tag:
        conditions.append(sa.or_(*(tags.contains(json.dumps(tag), autoescape=True) for tag in filters.tag)))
    return conditions


def _printed_id() -> sa.ColumnElement[str]:
    digits = sa.cast(Run.id, sa.String)
    padded = sa.func.substr("0000" + digits, sa.func.length(digits) + 1)
    return "R-" + sa.case((Run.id < 10_000, padded), else_=digits)


def _counts(reader: sa.Connection, found: list[sa.ColumnElement[bool]]) -> dict[str, int]:
    counts = dict.fromkeys(("total", *get_args(RunState), *get_args(VerdictWord)), 0)
    groups = sa.select(Run.state, Run.verdict, sa.func.count()).group_by(Run.state, Run.verdict)
    if found:
        groups = groups.join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(*found)
    for state, verdict, count in reader.execute(groups):
        counts["total"] += count
        counts[state] += count
        if verdict is not None:
            counts[verdict] += count
    return counts


def _order(sort: Sort) -> list[sa.ColumnElement[Any]]:
    """By value, what has none last in either direction, newest first among equals."""
    if sort.endswith("created"):
        return [Run.id.desc() if sort.startswith("-") else Run.id.asc()]
    value = _SORTS[sort.lstrip("-")]
    return [value.is_(None), value.desc() if sort.startswith("-") else value.asc(), Run.id.desc()]


def _after(sort: Sort, value: Any, run_id: int) -> sa.ColumnElement[bool]:
    """The rows behind the one with this value and number, in the order of `_order`."""
    down = sort.startswith("-")
    if sort.endswith("created"):
        return Run.id < run_id if down else Run.id > run_id
    column = _SORTS[sort.lstrip("-")]
    if value is None:
        return sa.and_(column.is_(None), Run.id < run_id)
    further = column < value if down else column > value
    return sa.or_(further, sa.and_(column == value, Run.id < run_id), column.is_(None))


def _encode(sort: Sort, value: Any, run_id: int) -> str:
    return base64.urlsafe_b64encode(json.dumps([sort, value, run_id]).encode()).decode().rstrip("=")


def _decode(cursor: str, sort: Sort) -> tuple[Any, int]:
    try:
        text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True)
        of, value, run_id = json.loads(text)
    except (binascii.Error, ValueError, TypeError):
        raise _bad(cursor, "not one that this service gave; start again without a cursor") from None
    fits = value is None or isinstance(
        value, str if isinstance(_SORTS[sort.lstrip("-")].type, sa.String) else (int, float)
    )
    if of != sort:
        raise _bad(cursor, f"from a list sorted by {of}, this one is sorted by {sort}; start again without a cursor")
    if not fits or isinstance(run_id, bool) or not isinstance(run_id, int) or not 0 <= run_id < 2**62:
        raise _bad(cursor, "not one that this service gave; start again without a cursor")
    return value, run_id


def _bad(cursor: str, message: str) -> RefusedError:
    problem = Problem("cursor", cursor[:120], message)
    return RefusedError(422, "bad-cursor", str(problem), [problem])
