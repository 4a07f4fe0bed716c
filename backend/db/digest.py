"""The digest of a run's results: what a reviewer signs, and how a file of the run is checked for changes.

SHA-256 over the canonical JSON of campaign digest, state, verdict, findings and stage results, over the bytes of the
stored traces, and over the component descriptions stored with the run: only these map points of the unit cube to
physical values. Names, tags, notes and times are not results.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import sqlalchemy as sa

from backend.db import snapshots
from backend.db.tables import Finding, Run, Stage, Trace

_RUN = ("campaign_digest", "state", "verdict", "reason", "error", "summary", "nominal_cost", "worst_cost")
_STAGE = ("position", "kind", "method", "state", "planned", "evaluations", "failed", "excluded", "best", "best_index")
_EVIDENCE = ("label", "slices", "boundary", "closest")
_FINDING = ("label", "cost", "margin", "parameters", "point", "methods", "found", "at_bounds", "validation")


def results_digest(reader: sa.Connection, run_id: int, evidence: bool = True) -> str:
    """64 hexadecimal digits; any change of a result changes them. Revisions up to 0010 used `evidence=False`."""
    parts = {
        "run": _rows(reader, Run, _RUN, Run.id == run_id, Run.id),
        "stages": _rows(reader, Stage, (*_STAGE, "result"), Stage.run_id == run_id, Stage.position),
        "findings": _rows(reader, Finding, _FINDING, Finding.run_id == run_id, Finding.label),
        "traces": _traces(reader, run_id),
    }
    if evidence:
        shown = _rows(reader, Finding, _EVIDENCE, Finding.run_id == run_id, Finding.label)
        if any(value is not None for _, *values in shown for value in values):
            parts["evidence"] = shown
    components = snapshots.digest(reader, run_id)
    if components is not None:  # runs without a snapshot keep the digest under which they were signed
        parts["components"] = [[components]]
    canonical = json.dumps(parts, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _rows(reader: sa.Connection, table: Any, names: tuple[str, ...], of: Any, order: Any) -> list[list[Any]]:
    query = sa.select(*(getattr(table, name) for name in names)).where(of).order_by(order)
    return [list(row) for row in reader.execute(query)]


def _traces(reader: sa.Connection, run_id: int) -> list[list[Any]]:
    columns = (Trace.name, Trace.columns, Trace.rows, Trace.meta, Trace.data)
    rows = reader.execute(sa.select(*columns).where(Trace.run_id == run_id).order_by(Trace.name))
    return [[*row[:-1], hashlib.sha256(row.data).hexdigest()] for row in rows]
