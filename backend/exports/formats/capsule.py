"""A finding as one file: campaign, components, parameters, trajectories, versions, digests, and its view in 3D.

`clearance replay FILE` evaluates it again without a service; `flight.html` in it opens offline. `{label}` is F1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import sqlalchemy as sa
from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response
from numpy.typing import NDArray

from backend.catalog.service import snapshot_of
from backend.db import codes, continuation, sources
from backend.db.digest import results_digest
from backend.db.engine import ask
from backend.exports import service
from backend.exports.format import Format, Stored, Words
from backend.http.deps import account, capacities
from backend.http.errors import RefusedError, not_found
from backend.http.versions import readable
from backend.results import service as results
from backend.runs import service as runs
from campaigns.capsules.capsule import Origin, Trajectory
from campaigns.capsules.packing import Content, packed
from campaigns.results.trace import TraceColumn, TraceHead
from campaigns.runs import run_name


def content(reader: sa.Connection, run_id: int, label: str) -> Content:
    """What the capsule of a finding contains, without its page; 404 if there is no such run or finding."""
    detail = runs.detail(reader, run_id)
    with readable(f"a finding of {run_name(run_id)}", reader, run_id):
        found = {finding.label: finding for finding in continuation.findings(reader, run_id)}
    if label not in found:
        raise not_found("finding of this run called", label)
    versions = continuation.versions(reader, run_id)
    first = next(iter(runs.stages(reader, run_id)), None)
    nominal = None if first is None else first.result
    verdict = detail.summary
    with readable(f"a trajectory of {run_name(run_id)}", reader, run_id):
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
        components=snapshot_of(reader, run_id),
        measured=None if nominal is None else nominal.repeatability,
        trajectories=trajectories,
        sources=sources.of_run(reader, run_id),
    )


def _trajectories(reader: sa.Connection, run_id: int, label: str) -> Iterator[tuple[Trajectory, NDArray[np.float64]]]:
    for name in ("nominal", label):
        row = results.stored(reader, run_id, name)
        if row is None:
            continue
        columns = [TraceColumn.model_validate(column) for column in row.columns]
        yield Trajectory(name=row.name, columns=columns, head=TraceHead.model_validate(row.meta)), results.table(row)


def _words(stored: Stored) -> Words:
    text = "Everything that evaluates it again without a service (clearance replay FILE), and its view in 3D"
    return Words(f"Finding {stored.findings[0]}, capsule", text)


async def _answer(request: Request, run: str, label: str, dark: bool) -> Response:
    run_id = runs.number(run)

    def looked(reader: sa.Connection) -> tuple[Content, dict[str, str]]:
        return content(reader, run_id, label), service.headers(reader, run_id, f"capsule-{label}.zip")

    found, headers = await run_in_threadpool(ask, request.app.state.engine, looked)
    if service.unchanged(request, headers):
        return Response(status_code=304, headers=headers)
    page = await _page_of(request, run_id, label)
    files = capacities(request).files
    made = await files.run(account(request), lambda: packed(replace(found, page=page)), request.is_disconnected)
    return Response(made, headers=headers, media_type=export.media_type)


async def _page_of(request: Request, run_id: int, finding: str) -> str:
    """The recording of a finding; empty if nothing of it can be drawn."""
    try:
        recordings = request.app.state.recordings
        recorded = await recordings.page(account(request), run_id, finding, gone=request.is_disconnected)
    except RefusedError as error:
        if error.status == 503:
            raise
        return ""
    return "" if isinstance(recorded, str) else str(recorded.html)


export = Format(
    file="capsule-{label}.zip",
    order=9,
    media_type="application/zip",
    words=_words,
    answer=_answer,
    offered=lambda stored: next(iter(stored.findings), None),
)
