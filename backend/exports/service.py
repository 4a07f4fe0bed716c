"""The export files of a run: their list, and what all of them have."""

from __future__ import annotations

import hashlib

import sqlalchemy as sa
from fastapi import Request

from backend.catalog.installation import installation
from backend.catalog.service import published_digest
from backend.db.tables import Finding, Trace
from backend.exports.format import LABEL, Stored, known
from backend.http.naming import disposition, named
from backend.http.root import at
from backend.http.schema import Schema
from backend.runs import service as runs
from backend.signoffs import service as signoffs
from campaigns.runs import ENDED


def files(reader: sa.Connection, run_id: int) -> list[ExportFile]:
    """The export files of a run; 404 if there is no such run."""
    run, stored = runs.summary(reader, run_id), _stored(reader, run_id)
    found = []
    for one in known():
        label = one.offered(stored)
        if label is None:
            continue
        title, text = one.words(stored)
        file = one.file.replace(LABEL, label)
        found.append(
            ExportFile(
                name=named(run.id, run.name, file),
                file=one.address or file,
                title=title,
                text=text,
                media_type=one.media_type,
                href=at(f"/api/v1/runs/{run.id}/{one.address or f'exports/{file}'}"),
                unavailable=one.unavailable(stored),
            )
        )
    return found


def _stored(reader: sa.Connection, run_id: int) -> Stored:
    traces = reader.execute(sa.select(Trace.name, Trace.meta).where(Trace.run_id == run_id)).all()
    simulated = runs.campaign(reader, run_id).scenario is None
    drawn = [row.name for row in traces if not simulated or row.meta.get("scene")]
    labels = reader.scalars(sa.select(Finding.label).where(Finding.run_id == run_id))
    flights, seen, findings = (
        tuple(sorted(names, key=lambda name: (len(name), name)))
        for names in ([row.name for row in traces], drawn, labels)
    )
    return Stored(simulated, flights, seen, findings)


def headers(reader: sa.Connection, run_id: int, file: str) -> dict[str, str]:
    """The headers of a file: the name under which it is saved, and its entity tag once the run has ended."""
    run, known_as = runs.summary(reader, run_id), tag(reader, run_id)
    saved = {"Content-Disposition": disposition("attachment", named(run.id, run.name, file))}
    return saved if known_as is None else saved | {"ETag": known_as, "Cache-Control": "private, no-cache"}


def unchanged(request: Request, answer: dict[str, str]) -> bool:
    """Whether the client has the file with these headers already."""
    return "ETag" in answer and answer["ETag"] in request.headers.get("if-none-match", "")


def tag(reader: sa.Connection, run_id: int) -> str | None:
    """The entity tag of the run's files (RFC 9110, 8.8.3); None while the run is active.

    It covers everything in them: results, annotations, sign-offs, and the catalogue with its units.
    """
    run = runs.detail(reader, run_id)
    if run.state not in ENDED:
        return None
    now = installation(reader)
    parts = [run.model_dump_json(), signoffs.listed(reader, run_id).model_dump_json(), published_digest(reader)]
    parts += [now.reason, *sorted(now.absent)]
    return f'W/"{hashlib.sha256("".join(parts).encode()).hexdigest()}"'


class ExportFile(Schema):
    """An export file: its name, its content and its address."""

    name: str
    """R-0001-unicycle-past-a-pillar-evaluations.csv"""
    file: str
    """Its name without that of the run: evaluations.csv"""
    title: str
    text: str
    media_type: str
    href: str
    unavailable: str | None
    """The reason why it is not available now; None if it is."""
