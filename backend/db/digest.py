"""The digest of a run's results: what a reviewer signs, and how a file of the run is checked for changes.

It is the evidence digest (`campaigns.stored.digest`) over the run's campaign, its evaluations, state, verdict, findings
and stage results, over the bytes of the stored traces, and over the component descriptions stored with the run: only
these map points of the unit cube to physical values. Names, tags, notes and times are not results.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from typing import Any

import sqlalchemy as sa

from backend.db import revision, snapshots
from backend.db.engine import once
from backend.db.tables import CampaignRow, EvaluationChunk, Finding, Run, Stage, Trace
from campaigns.documents import digest_of
from campaigns.stored.digest import Rows, evidence_digest

EVIDENCE = "evidence"
"""Where the provenance of a verdict has it; runs of earlier versions have none, and a digest without evaluations."""
_RUN = ("campaign_digest", "state", "verdict", "reason", "error", "summary", "nominal_cost", "worst_cost")
_STAGE = ("position", "kind", "method", "state", "planned", "evaluations", "failed", "excluded", "best", "best_index")
_COUNTED = "0031"
"""The revision since which a stage has evaluations that are only counted."""
_EVIDENCE = ("label", "slices", "boundary", "closest")
_FINDING = ("label", "cost", "margin", "parameters", "point", "methods", "found", "at_bounds", "validation")


def results_digest(reader: sa.Connection, run_id: int, evidence: bool = True) -> str:
    """64 hexadecimal digits; any change of a result changes them. Revisions up to 0010 used `evidence=False`."""
    return once(reader, ("results", run_id, evidence), lambda: _computed(reader, run_id, evidence))


def _computed(reader: sa.Connection, run_id: int, evidence: bool) -> str:
    stated = sa.select(Run.summary["provenance"][EVIDENCE].as_string()).where(Run.id == run_id)
    if reader.scalar(stated) is not None:
        return current_digest(reader, run_id)
    return digest_of(_parts(reader, run_id, evidence))


def digest_before_0033(reader: sa.Connection, run_id: int) -> str:
    """The digest of a run without a verdict before revision 0033: its lowest value was that of its searches alone."""
    parts = _parts(reader, run_id)
    lowest = sa.select(sa.func.min(Stage.best)).where(Stage.run_id == run_id, Stage.method.is_not(None))
    for row in parts["run"]:
        row[_RUN.index("worst_cost")] = reader.scalar(lowest)
    return digest_of(parts)


def current_digest(reader: sa.Connection, run_id: int) -> str:
    """The evidence digest of what is stored now, whether or not the run states one."""
    of = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    campaign = digest_of(reader.execute(of).scalar_one())
    parts = _parts(reader, run_id)
    summary = _RUN.index("summary")
    for row in parts["run"]:  # without the digest, which cannot cover itself
        known = row[summary].get("provenance") or {}
        row[summary] = row[summary] | {"provenance": {k: v for k, v in known.items() if k != EVIDENCE}}
    return evidence_digest(campaign, _evaluations(reader, run_id), parts)


def _parts(reader: sa.Connection, run_id: int, evidence: bool = True) -> dict[str, list[list[Any]]]:
    parts = {
        "run": _rows(reader, Run, _RUN, Run.id == run_id, Run.id),
        "stages": _rows(reader, Stage, (*_STAGE, "result"), Stage.run_id == run_id, Stage.position),
        "findings": _rows(reader, Finding, _FINDING, Finding.run_id == run_id, Finding.label),
        "traces": _traces(reader, run_id),
    }
    if apart := _apart(reader, run_id):
        parts["counted"] = apart
    if evidence:
        shown = _rows(reader, Finding, _EVIDENCE, Finding.run_id == run_id, Finding.label)
        if any(value is not None for _, *values in shown for value in values):
            parts["evidence"] = shown
    components = snapshots.digest(reader, run_id)
    if components is not None:  # runs without a snapshot keep the digest under which they were signed
        parts["components"] = [[components]]
    return parts


def _apart(reader: sa.Connection, run_id: int) -> list[list[int]]:
    """Position, counted and violations of the stages whose blocks do not give these numbers: a changed number changes
    the digest, and whoever signed before it covered them signed the same digest."""
    stored = once(reader, "revision", lambda: revision.stored(reader))
    if (stored or _COUNTED) < _COUNTED:
        return []
    columns = (Stage.position, Stage.evaluations, Stage.counted, Stage.violations, Stage.result["blocks"])
    found = []
    of = sa.select(*columns).where(Stage.run_id == run_id).order_by(Stage.position)
    for position, evaluations, counted, violations, blocks in reader.execute(of):
        follows = (sum(blocks["draws"]) - evaluations, sum(blocks["violations"])) if blocks else (0, 0)
        if (counted, violations) != follows:
            found.append([position, counted, violations])
    return found


def _evaluations(reader: sa.Connection, run_id: int) -> Iterator[Rows]:
    of = sa.select(EvaluationChunk.position, EvaluationChunk.points, EvaluationChunk.costs, EvaluationChunk.status)
    of = of.where(EvaluationChunk.run_id == run_id).order_by(EvaluationChunk.position, EvaluationChunk.first)
    return (Rows(*row) for row in reader.execute(of))


def _rows(reader: sa.Connection, table: Any, names: tuple[str, ...], of: Any, order: Any) -> list[list[Any]]:
    query = sa.select(*(getattr(table, name) for name in names)).where(of).order_by(order)
    return [list(row) for row in reader.execute(query)]


def _traces(reader: sa.Connection, run_id: int) -> list[list[Any]]:
    columns = (Trace.name, Trace.columns, Trace.rows, Trace.meta, Trace.data)
    rows = reader.execute(sa.select(*columns).where(Trace.run_id == run_id).order_by(Trace.name))
    return [[*row[:-1], hashlib.sha256(row.data).hexdigest()] for row in rows]
