"""Rows of the tables as records, and records as rows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, TypedDict

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from backend.db.engine import chunks as portions
from backend.db.tables import EvaluationChunk, Run, Stage
from backend.db.tables import Finding as FindingRow
from campaigns.results import Finding, StageResult
from campaigns.results.base import FAILED, OK, TIMEOUT
from campaigns.results.finding import Validation
from campaigns.runs import StageState
from campaigns.stages.found import declared, stage_result
from campaigns.stored.records import Columns, Trace, join


def as_array(data: bytes, rows: int) -> NDArray[np.float64]:
    """Stored numbers (rows, n); read-only, like the bytes."""
    return np.frombuffer(data, dtype="<f8").reshape(rows, -1)


def as_columns(row: Any) -> Columns:
    points, costs, seconds = (
        as_array(data, row.count).astype(np.float64) for data in (row.points, row.costs, row.seconds)
    )
    reasons = {int(index): reason for index, reason in row.reasons.items()}
    return Columns(points, costs, np.frombuffer(row.status, dtype=np.uint8).copy(), seconds[:, 0], reasons)


def as_finding(row: sa.RowMapping) -> Finding:
    return Finding.model_validate(dict(row))


def as_result(stored: Any) -> StageResult | None:
    return None if stored is None else stage_result(stored)


def plain(value: Any) -> Any:
    """The value as plain JSON: NumPy numbers become Python numbers, non-finite numbers become None."""
    if isinstance(value, BaseModel):
        return plain(value.model_dump())
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


MOST_ROWS = 4096
"""Of a chunk: whoever reads one has all of it in memory."""


def chunk_rows(run_id: int, position: int, first: int, columns: Columns) -> list[dict[str, object]]:
    """Evaluations of a stage that begin at `first` as rows of the chunk table."""
    found: list[dict[str, object]] = []
    for begin in range(0, len(columns.status), MOST_ROWS):
        at, rows = first + begin, slice(begin, begin + MOST_ROWS)
        reasons = sorted(columns.reasons.keys() & set(range(at, at + MOST_ROWS)))
        status = np.ascontiguousarray(columns.status[rows], dtype=np.uint8)
        found.append({
            "run_id": run_id,
            "position": position,
            "first": at,
            "count": len(status),
            "points": _bytes(columns.points[rows]),
            "costs": _bytes(columns.costs[rows]),
            "status": status.tobytes(),
            "seconds": _bytes(columns.seconds[rows]),
            "reasons": {str(index): columns.reasons[index] for index in reasons},
        })  # fmt: skip
    return found


def _bytes(array: Any) -> bytes:
    return np.ascontiguousarray(array, dtype="<f8").tobytes()


def failed(columns: Columns) -> int:
    """How many evaluations failed, timeouts included."""
    return int(np.isin(columns.status, (FAILED, TIMEOUT)).sum())


BLOCK = 4
"""Number of chunks of a stage that are in memory at once while they are read one by one."""


def chunks(
    reader: sa.Connection, run_id: int, position: int, *columns: Any, where: sa.ColumnElement[bool] | None = None
) -> Iterator[Any]:
    """These columns of the chunks of a stage, in order, never more than a few at once."""
    query = sa.select(*columns).where(EvaluationChunk.run_id == run_id, EvaluationChunk.position == position)
    query = (query if where is None else query.where(where)).order_by(EvaluationChunk.first)
    yield from reader.execute(query.execution_options(yield_per=BLOCK))


def stored_columns(reader: sa.Connection, run_id: int, position: int) -> Columns | None:
    """All stored evaluations of a stage, in order; None if there are none."""
    return join([as_columns(row) for row in chunks(reader, run_id, position, EvaluationChunk)])


def lowest(columns: Columns) -> tuple[float, int | None]:
    """The lowest cost among ok evaluations by the first criterion, and its row; the first of equal ones."""
    ok = np.flatnonzero((columns.status == OK) & np.isfinite(columns.costs[:, 0]))
    if not len(ok):
        return math.nan, None
    index = int(ok[np.argmin(columns.costs[ok, 0])])
    return float(columns.costs[index, 0]), index


def finding_row(finding: Finding) -> dict[str, object]:
    return {**plain(finding), "cost": finding.cost, "margin": finding.margin}


class TraceRow(TypedDict):
    name: str
    columns: list[Any]
    rows: int
    data: bytes
    meta: dict[str, Any]


def trace_row(trace: Trace) -> TraceRow:
    return {
        "name": trace.name,
        "columns": plain(trace.columns),
        "rows": len(trace.data),
        "data": _bytes(trace.data),
        "meta": plain(trace.meta),
    }


def own_question() -> sa.ColumnElement[bool]:
    """Whether a stage evaluates the question of its campaign."""
    return Stage.kind.in_(_kinds())


def at_or_below(limit: sa.ColumnExpressionArgument[float | None] | float) -> sa.ColumnElement[bool]:
    """Whether a run found a value at or below the limit, in a stage or in an evaluation made again."""
    stages = sa.select(Stage.run_id).where(Stage.run_id == Run.id, own_question(), Stage.best <= limit)
    return sa.or_(Run.worst_cost <= limit, Run.made_again <= limit, stages.exists())


def lowered(connection: sa.Connection, run_id: int, kind: str, method: str | None, cost: float) -> None:
    """A stage of the kind has evaluated a cost; `method` is that of a search."""
    if kind not in _kinds():
        return
    lower = sa.or_(Run.worst_cost.is_(None), Run.worst_cost > cost)
    connection.execute(sa.update(Run).where(Run.id == run_id, lower).values(worst_cost=cost, worst_method=method))


def made_again(connection: sa.Connection, run_id: int, result: StageResult, findings: Sequence[Finding]) -> None:
    """A stage has ended: keep the lowest value that it saw in evaluations made again, its own or those of findings, and
    after the horizon.

    The first is the lowest value of the run as well until a verdict states another: a run may end without one.
    """
    if result.later:
        later = min(-math.inf if value is None else value for _, value in result.later)
        connection.execute(sa.update(Run).where(Run.id == run_id).values(later=later))
    if values := _seen(result, (f.validation for f in findings)):
        for column in (Run.made_again, Run.worst_cost):
            lower = sa.or_(column.is_(None), column > min(values))
            connection.execute(sa.update(Run).where(Run.id == run_id, lower).values({column: min(values)}))


def made_again_before(reader: sa.Connection, runs: Sequence[int]) -> dict[int, float]:
    """The same of these runs, which workers of earlier versions ended without keeping it, by run."""
    found: dict[int, float] = {}
    for some in portions(runs):
        ended = sa.select(Stage.run_id, Stage.result).where(_confirmed(), Stage.run_id.in_(some))
        results = reader.execute(ended).all()
        cases: dict[int, list[Any]] = {run_id: [] for run_id, _ in results}
        of = sa.select(FindingRow.run_id, FindingRow.validation).where(FindingRow.run_id.in_(cases))
        for run_id, case in reader.execute(of) if cases else ():
            cases[run_id].append(case)
        for run_id, stored in results:
            with suppress(ValidationError):  # of another version, whose values are unknown here
                result = as_result(stored)
                confirmed = [None if case is None else Validation.model_validate(case) for case in cases[run_id]]
                if result is not None and (values := _seen(result, confirmed)):
                    found[run_id] = min(values)
    return found


def unread() -> sa.ColumnElement[bool]:
    """Whether only `made_again_before` can tell the lowest value that a run saw again."""
    return sa.and_(
        Run.made_again.is_(None), sa.select(Stage.run_id).where(Stage.run_id == Run.id, _confirmed()).exists()
    )


def _confirmed() -> sa.ColumnElement[bool]:
    kinds = [kind for kind, stage in declared().items() if stage.of_findings]
    return sa.and_(Stage.kind.in_(kinds), Stage.state == StageState.DONE)


def _seen(result: StageResult, cases: Iterable[Validation | None]) -> list[float]:
    return [*result.made_again, *(value for case in cases if case is not None for value in case.values)]


def _kinds() -> list[str]:
    return [stage.kind for stage in declared().values() if stage.against]
