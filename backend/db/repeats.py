"""The digest of what a run evaluated and found, without times and machine: equal for two runs that repeat each other.

SHA-256 over verdict, stage results, findings and traces as canonical JSON, and over points, costs and status of every
evaluation, bit by bit, however they were divided into chunks; and over the descriptions of the components.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from typing import Any

import sqlalchemy as sa
from pydantic import BaseModel

from backend.db import snapshots
from backend.db.rows import as_result
from backend.db.tables import EvaluationChunk, Finding, Run, Stage, Trace
from campaigns.results import Verdict

_RUN = ("state", "verdict", "reason", "error", "summary", "nominal_cost", "worst_cost")
_STAGE = (
    "position", "kind", "method", "state", "evaluations", "counted", "violations", "failed", "excluded", "best",
    "best_index", "result",
)  # fmt: skip
_FINDING = (
    "label", "cost", "margin", "parameters", "point", "methods", "found", "at_bounds", "validation", "slices",
    "boundary", "closest",
)  # fmt: skip
_TRACE = ("name", "columns", "rows", "meta")
_BITS = ("points", "costs", "status")
NOT_REPEATED = {"seconds", "call_seconds", "start_seconds", "slots", "provenance"}
"""The fields of results, at any depth, that are left out: working times, and the machine. A parameter or a result of a
simulator with such a name is a key of a mapping, not a field, and is compared."""
_TYPES: dict[str, Callable[[Any], Any]] = {"result": as_result, "summary": Verdict.model_validate}
"""The columns that have such fields."""


def repeat_digest(reader: sa.Connection, run_id: int) -> str:
    parts = [
        _rows(reader, table, names, order, run_id)
        for table, names, order in (
            (Stage, _STAGE, Stage.position),
            (Finding, _FINDING, Finding.label),
            (Trace, _TRACE, Trace.name),
        )
    ]
    parts.append([_repeated(row) for row in reader.execute(sa.select(*_columns(Run, _RUN)).where(Run.id == run_id))])
    parts.append([[snapshots.digest(reader, run_id)]])
    canonical = json.dumps(parts, sort_keys=True, separators=(",", ":"), allow_nan=False)
    whole = hashlib.sha256(canonical.encode())
    traces = sa.select(Trace.data).where(Trace.run_id == run_id).order_by(Trace.name)
    for data in reader.scalars(traces):
        whole.update(hashlib.sha256(data).digest())
    for digest in _evaluations(reader, run_id):
        whole.update(digest)
    return whole.hexdigest()


def _evaluations(reader: sa.Connection, run_id: int) -> list[bytes]:
    """The digest of each column of each stage; one chunk at a time in memory."""
    of = sa.select(EvaluationChunk.position, *_columns(EvaluationChunk, _BITS)).where(EvaluationChunk.run_id == run_id)
    found: dict[int, list[Any]] = {}
    with reader.execute(of.order_by(EvaluationChunk.position, EvaluationChunk.first)) as rows:
        for position, *columns in rows:
            for digest, column in zip(
                found.setdefault(position, [hashlib.sha256() for _ in _BITS]), columns, strict=True
            ):
                digest.update(column)
    return [digest.digest() for digests in found.values() for digest in digests]


def _rows(reader: sa.Connection, table: Any, names: tuple[str, ...], order: Any, run_id: int) -> list[list[Any]]:
    of = sa.select(*_columns(table, names)).where(table.run_id == run_id).order_by(order)
    return [_repeated(row) for row in reader.execute(of)]


def _columns(table: Any, names: tuple[str, ...]) -> list[Any]:
    return [getattr(table, name) for name in names]


def _repeated(row: Any) -> list[Any]:
    return [
        _without(value, _TYPES[name](value)) if name in _TYPES and value else value
        for name, value in row._mapping.items()
    ]


def _without(stored: Any, typed: Any) -> Any:
    """A stored value without the fields that are not repeated; typed: the same value as its type, which has them."""
    if isinstance(typed, BaseModel):
        left_out = NOT_REPEATED & type(typed).model_fields.keys()
        return {key: _without(one, getattr(typed, key, None)) for key, one in stored.items() if key not in left_out}
    if isinstance(typed, Mapping):
        return {key: _without(one, typed.get(key)) for key, one in stored.items()}
    if isinstance(typed, list):
        return [_without(*pair) for pair in zip(stored, typed, strict=True)]
    return stored
