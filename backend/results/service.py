"""Findings and traces as stored."""

from __future__ import annotations

from typing import Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db.tables import Finding, Run, Trace
from backend.http.errors import existing
from backend.http.versions import readable
from backend.http.written import finite_all
from backend.results import likely
from backend.results.likely import Limits
from backend.results.schemas import FindingDetail, TraceData, TraceInfo
from backend.runs.earlier import Terms, terms_of
from backend.runs.service import campaign, require
from campaigns import thin
from campaigns.claims import earlier
from campaigns.densities.joint import Joint
from campaigns.densities.likelihood import likelihood
from campaigns.results import TraceHead
from campaigns.results.trace import TraceColumn
from campaigns.runs import run_name


def findings(reader: sa.Connection, run_id: int) -> list[FindingDetail]:
    """The findings of a run, the lowest first; 404 if there is no such run."""
    limits, of = likely.densities(reader, run_id, campaign(reader, run_id))
    rows = reader.execute(sa.select(Finding).where(Finding.run_id == run_id)).all()
    ordered = sorted(rows, key=lambda row: (len(row.label), row.label))
    traced = {flight.name: flight.meta for flight in traces(reader, run_id)} if ordered else {}
    with readable(f"a finding of {run_name(run_id)}", reader, run_id):
        terms = terms_of(reader, run_id)
        found = [_finding(row, limits, of, traced.get(row.label), terms) for row in ordered]
    threshold = reader.scalar(sa.select(Run.threshold).where(Run.id == run_id))
    return [_stated(one, threshold) for one in found]


def _stated(finding: FindingDetail, threshold: float | None) -> FindingDetail:
    """The finding with the margin of the value to state for it, which the list of runs has for the worst case too."""
    if finding.granted == finding.cost or threshold is None:
        return finding
    return finding.model_copy(update={"margin": finding.granted - threshold})


def _finding(row: Any, limits: Limits, of: Joint | None, head: TraceHead | None, terms: Terms) -> FindingDetail:
    nominal, low, high = ({path: triple[k] for path, triple in limits.items()} for k in range(3))
    columns = ("label", "cost", "margin", "parameters", "methods", "found", "at_bounds", "validation")
    values = {column: getattr(row, column) for column in (*columns, "slices", "boundary", "closest")}
    others = {"nominal": nominal, "low": low, "high": high, "values": {} if head is None else head.values}
    unknown = of is None or not row.parameters.keys() >= of.shapes.keys()
    likely = {"likelihood": None if of is None or unknown else likelihood(of, of.point(row.parameters))}
    return FindingDetail.model_validate(earlier.spoken(values, terms) | others | likely)


def traces(reader: sa.Connection, run_id: int) -> list[TraceInfo]:
    """The stored flights, the nominal one first; 404 if there is no such run."""
    require(reader, run_id)
    rows = reader.execute(sa.select(Trace.name, Trace.rows, Trace.columns, Trace.meta).where(Trace.run_id == run_id))
    ordered = sorted(rows, key=lambda row: (row.name != "nominal", len(row.name), row.name))
    with readable(f"a flight of {run_name(run_id)}", reader, run_id):
        return [TraceInfo.model_validate(dict(row._mapping)) for row in ordered]


def trace(reader: sa.Connection, run_id: int, name: str, most: int) -> TraceData:
    """One flight, thinned to `most` rows; 404 if there is no such run or flight."""
    require(reader, run_id)
    row = existing(stored(reader, run_id, name), "stored flight of this run called", name)
    data = table(row)
    with readable(f"flight {name} of {run_name(run_id)}", reader, run_id):
        head, columns = TraceHead.model_validate(row.meta), [TraceColumn.model_validate(c) for c in row.columns]
    chosen = thin.around(len(data), most, closest_row(head, columns, data))
    return TraceData(
        name=row.name,
        rows=row.rows,
        columns=columns,
        meta=head,
        data={column.name: finite_all(data[chosen, k]) for k, column in enumerate(columns)},
    )


def stored(reader: sa.Connection, run_id: int, name: str) -> Any:
    return reader.execute(sa.select(Trace).where(Trace.run_id == run_id, Trace.name == name)).one_or_none()


def table(row: Any) -> NDArray[np.float64]:
    return np.frombuffer(row.data, dtype="<f8").reshape(row.rows, len(row.columns))


def closest_row(head: TraceHead, columns: list[TraceColumn], data: NDArray[np.float64]) -> int:
    """The row at the closest approach: by its stored time, else by the lowest separation, else the first."""
    groups = [column.group for column in columns]
    if head.closest is not None and "time" in groups:
        return int(np.abs(data[:, groups.index("time")] - head.closest.time).argmin())
    if "separation" in groups and not np.isnan(data[:, groups.index("separation")]).all():
        return int(np.nanargmin(data[:, groups.index("separation")]))
    return 0
