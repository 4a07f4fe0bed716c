"""The capsule of a finding, from the stored run."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db import codes, continuation, snapshots, sources
from backend.db.digest import results_digest
from backend.http.errors import not_found
from backend.results import service as results
from backend.runs import service as runs
from backend.runs.versions import readable
from campaigns.capsules.capsule import Origin, Trajectory
from campaigns.capsules.packing import Content
from campaigns.results import NominalResult
from campaigns.results.trace import TraceColumn, TraceHead
from campaigns.runs import run_name


def content(reader: sa.Connection, run_id: int, label: str) -> Content:
    """What the capsule of a finding contains, without its page; 404 if there is no such run or finding."""
    detail = runs.detail(reader, run_id)
    with readable(f"a finding of {run_name(run_id)}"):
        found = {finding.label: finding for finding in continuation.findings(reader, run_id)}
    if label not in found:
        raise not_found("finding of this run called", label)
    versions = continuation.versions(reader, run_id)
    first = next(iter(runs.stages(reader, run_id)), None)
    nominal = None if first is None else first.result
    verdict = detail.summary
    with readable(f"a trajectory of {run_name(run_id)}"):
        trajectories = list(_trajectories(reader, run_id, label))
    return Content(
        origin=Origin(
            run=detail.id,
            name=detail.name,
            verdict=detail.verdict or "",
            sentence="" if verdict is None else verdict.sentence,
            results=results_digest(reader, run_id),
        ),
        campaign=detail.campaign,
        campaign_digest=detail.campaign_digest,
        finding=found[label],
        versions=versions,
        modules=codes.modules(reader, versions.code),
        components=snapshots.of_run(reader, run_id),
        measured=nominal.measured if isinstance(nominal, NominalResult) else None,
        trajectories=trajectories,
        sources=sources.of_run(reader, run_id),
    )


def _trajectories(reader: sa.Connection, run_id: int, label: str) -> Iterator[tuple[Trajectory, NDArray[np.float64]]]:
    """The trajectories of the nominal case and of the finding, if they are stored."""
    for name in ("nominal", label):
        row = results.stored(reader, run_id, name)
        if row is None:
            continue
        columns = [TraceColumn.model_validate(column) for column in row.columns]
        yield Trajectory(name=row.name, columns=columns, head=TraceHead.model_validate(row.meta)), results.table(row)
