"""Everything about a run as one JSON document, written while it is sent."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import sqlalchemy as sa

from backend.catalog.service import snapshot_of
from backend.db.digest import results_digest
from backend.db.engine import read
from backend.exports.format import Format, words
from backend.exports.sheet import Evaluated, Sheet, known, sheet
from backend.http.written import compact
from backend.results import likely
from backend.results import service as results
from backend.results.coverage import read as coverage
from backend.runs import service as runs
from backend.runs.components import components
from backend.signoffs import service as signoffs

FORMAT = "clearance-run/1"


def run_json(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    """All data of the run as one JSON document; evaluations are rows, preceded by their column names."""
    with read(engine) as reader:
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
        head = {
            "format": FORMAT,
            "results_digest": results_digest(reader, run_id),
            "run": runs.detail(reader, run_id).model_dump(mode="json"),
            "components": _components(reader, run_id),
            "signoffs": [s.model_dump(mode="json") for s in signoffs.listed(reader, run_id).items],
            "findings": [f.model_dump(mode="json") for f in results.findings(reader, run_id)],
            "coverage": coverage.read(reader, run_id).model_dump(mode="json"),
            "most_likely_violation": likely.violation(reader, run_id).model_dump(mode="json"),
        }
        stages = [s.model_dump(mode="json") for s in runs.stages(reader, run_id)]
        flights = [flight.name for flight in results.traces(reader, run_id)]
    return _run_json(engine, found, head, stages, flights)


def _components(reader: sa.Connection, run_id: int) -> dict[str, object] | None:
    """The stored component descriptions; None if there are none, since the installed ones may differ."""
    descriptions = snapshot_of(reader, run_id) and components(reader, run_id)
    return descriptions.model_dump(mode="json") if descriptions else None


def _run_json(
    engine: sa.Engine, found: Sheet, head: Mapping[str, object], stages: list[dict[str, Any]], flights: list[str]
) -> Iterator[bytes]:
    yield (compact(head)[:-1] + f',"columns":{compact(found.columns)},"stages":[').encode()
    evaluated = {stage.position: stage for stage in found.stages}
    for i, stage in enumerate(stages):
        yield ((",\n" if i else "\n") + compact(stage)[:-1] + ',"rows":[').encode()
        if stage["position"] in evaluated:
            yield from _json_rows(engine, found, evaluated[stage["position"]])
        yield b"]}"
    yield b'],"traces":['
    for i, name in enumerate(flights):
        with read(engine) as reader:
            flight = results.trace(reader, found.run_id, name, 10**9)
        yield ((",\n" if i else "\n") + flight.model_dump_json()).encode()
    yield b"]}\n"


def _json_rows(engine: sa.Engine, found: Sheet, stage: Evaluated) -> Iterator[bytes]:
    first = True
    for block in found.blocks(engine, stage):
        rows = map(b",".join, zip(*block.written(b"null", _text, partial(known, missing=b"null")), strict=True))
        yield (b"\n[" if first else b",\n[") + b"],\n[".join(rows) + b"]"
        first = False


def _text(text: str | None) -> bytes:
    return compact(text).encode()


export = Format(
    file="run.json",
    order=1,
    media_type="application/json",
    words=words(
        "Everything, JSON",
        "Campaign, components, stages with every evaluation, findings, coverage, flights, verdict, versions",
        (
            "Everything, JSON",
            "Campaign, simulator, stages with every evaluation, findings, coverage, traces, verdict, versions",
        ),
    ),
    streamed=lambda engine, run_id: run_json(engine, run_id),
)
