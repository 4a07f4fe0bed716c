"""Reads the trace that a simulator returned: columns of equal length, each value a finite number or null.

A trace is no part of a verdict: whatever is wrong with it is a sentence.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from campaigns.results.base import Status
from campaigns.results.scene import Scene
from campaigns.results.trace import TraceColumn, TraceHead
from worker.engine.systems.base import Floats, NoTrace, Result, Trace
from worker.engine.systems.simulators.declared.columns import TIME, Column

MOST_ROWS = 100_000


def head(result: Result, value: float, values: Mapping[str, float], scene: Scene | None = None) -> TraceHead:
    """The header of the trace of one evaluation, whose deciding result has this value; scene: what is drawn of it."""
    cost = value if result.worse == "low" else 0.0 - value
    return TraceHead(parameters=dict(values), status=Status.OK, cost=cost, values={result.name: value}, scene=scene)


def read(name: str, columns: Mapping[str, Column], answer: Any, of: TraceHead) -> Trace:
    """The trace in an answer, `{"trace": {"time": [...], "x": [...]}}`; raises NoTrace with what is wrong with it."""
    lists = answer.get("trace") if isinstance(answer, Mapping) else None
    if not isinstance(lists, Mapping):
        raise NoTrace(f"its answer has no object `trace`, in which {', '.join(columns)} are expected")
    if missing := [column for column in columns if column not in lists]:
        listed = ", ".join(str(key)[:40] for key in list(lists)[:8]) or "nothing"
        raise NoTrace(f"its trace lacks {missing[0]}; it has {listed}")
    _have_rows(columns, lists)
    data = np.column_stack([_values(column, lists[column]) for column in columns])
    _in_order(data[:, list(columns).index(TIME)])
    return Trace(name, [_described(column, c) for column, c in columns.items()], data, of)


def _have_rows(columns: Mapping[str, Column], lists: Mapping[str, Any]) -> None:
    for column in columns:
        if not isinstance(lists[column], (list, tuple)):
            raise NoTrace(f"the column {column} of its trace is {lists[column]!r:.60}, not a list of numbers")
    rows = len(lists[TIME])
    for column in columns:
        if len(lists[column]) != rows:
            raise NoTrace(
                f"the column {column} of its trace has {len(lists[column])} rows and time has {rows}; the same number "
                "is expected"
            )
    if not 2 <= rows <= MOST_ROWS:
        raise NoTrace(f"its trace has {rows} rows; 2 to {MOST_ROWS} are expected")


def _values(column: str, values: Any) -> Floats:
    """A column as numbers, NaN for null; the first value that is neither is the reason."""
    found = np.empty(len(values))
    for row, value in enumerate(values):
        if value is None and column != TIME:
            found[row] = math.nan
            continue
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise NoTrace(f"{column} of its trace is {value!r:.60} in row {row + 1}, not a number{_or_null(column)}")
        try:
            found[row] = value
        except OverflowError:
            found[row] = math.inf
        if not math.isfinite(found[row]):
            raise NoTrace(
                f"{column} of its trace is {found[row]} in row {row + 1}; a finite number{_or_null(column)} is expected"
            )
    return found


def _or_null(column: str) -> str:
    return "" if column == TIME else " or null"


def _in_order(times: Floats) -> None:
    back = np.flatnonzero(np.diff(times) < 0)
    if len(back):
        before, after = times[back[0]], times[back[0] + 1]
        raise NoTrace(f"the time of its trace goes back from {before:g} s to {after:g} s after row {back[0] + 1}")


def _described(name: str, column: Column) -> TraceColumn:
    group: Literal["time", "signal"] = "time" if name == TIME else "signal"
    unit = "s" if name == TIME else column.unit
    return TraceColumn(name=name, symbol=column.symbol or name, unit=unit, group=group, text=column.text)
