"""Writes the export files of a run as iterators of bytes: JSON and CSV in pieces, the MAT-file at once.

Numbers are written at full precision (`repr`), so that they read back bit-identical. CSV: RFC 4180.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from backend.db import snapshots
from backend.db.digest import results_digest
from backend.db.engine import read
from backend.db.tables import CatalogueDocument, Finding, Trace
from backend.exports import mcap, parquet
from backend.exports.schemas import ExportFile
from backend.exports.sheet import Evaluated, Sheet, headings, sheet
from backend.http.naming import named
from backend.http.root import at
from backend.reports import pdf
from backend.results import service as results
from backend.runs import service as runs
from backend.runs.components import components
from backend.runs.schemas import RunSummary
from backend.signoffs import service as signoffs
from campaigns.cells import Writer
from campaigns.documents import JsonObject
from campaigns.results import NominalResult
from campaigns.results.base import Status
from campaigns.runs import ENDED

FORMAT = "clearance-run/1"


@dataclass(frozen=True)
class Kind:
    """One kind of file."""

    file: str
    title: str
    text: str
    media_type: str
    flights: bool = False
    findings: bool = False
    report: bool = False
    missing: Callable[[], str | None] = lambda: None
    """Why this installation cannot write it."""


REPORTS = (
    Kind("safety-case-report.html", "Safety-case report, HTML", "One file that prints on A4", "text/html", report=True),
    Kind("safety-case-report.pdf", "Safety-case report, PDF", "The report on A4 pages", "application/pdf", report=True),
)
FILES = (
    Kind(
        "run.json",
        "Everything, JSON",
        "Campaign, components, stages with every evaluation, findings, flights, verdict, versions",
        "application/json",
    ),
    Kind(
        "evaluations.csv",
        "Evaluations, CSV",
        "One row for each evaluation of every stage, parameters in their units",
        "text/csv",
    ),
    Kind(
        "evaluations.parquet",
        "Evaluations, Parquet",
        "The same as numbers with units, for pandas, Polars and DuckDB",
        "application/vnd.apache.parquet",
        missing=parquet.missing,
    ),
    Kind(
        "findings.csv",
        "Findings, CSV",
        "Nominal flight and every finding: all criteria, closest approach, parameters, validation",
        "text/csv",
        findings=True,
    ),
    Kind("traces.csv", "Flights, CSV", "Nominal flight and every finding over time", "text/csv", flights=True),
    Kind(
        "traces.mat",
        "Flights, MAT-file",
        "Flights for MATLAB, Octave and SciPy (version 5)",
        "application/x-matlab-data",
        flights=True,
    ),
    Kind(
        "traces.mcap",
        "Flights, MCAP",
        "Pose, trajectory, scene and separation for Foxglove",
        "application/x-mcap",
        flights=True,
        missing=mcap.missing,
    ),
)
PICTURE = Kind(
    "worst-case.svg",
    "Worst case, SVG",
    "Flights from above around the closest approach of the worst one",
    "image/svg+xml",
    flights=True,
)

SIMULATED = {
    kind.file: kind
    for kind in (
        Kind(
            "run.json",
            "Everything, JSON",
            "Campaign, simulator, stages with every evaluation, findings, traces, verdict, versions",
            "application/json",
        ),
        Kind(
            "findings.csv",
            "Findings, CSV",
            "Nominal case and every finding: result, parameters, validation",
            "text/csv",
            findings=True,
        ),
        Kind("traces.csv", "Traces, CSV", "Nominal case and every finding over time", "text/csv", flights=True),
        Kind(
            "traces.mat",
            "Traces, MAT-file",
            "Traces for MATLAB, Octave and SciPy (version 5)",
            "application/x-matlab-data",
            flights=True,
        ),
        Kind(
            "traces.mcap",
            "Traces, MCAP",
            "Pose, trajectory and scene where declared, and all signals, for Foxglove",
            "application/x-mcap",
            flights=True,
            missing=mcap.missing,
        ),
    )
}
"""Titles of the same files for a run that evaluates a simulator."""


def files(reader: sa.Connection, run_id: int) -> list[ExportFile]:
    """The export files of a run; 404 if there is no such run."""
    run = runs.summary(reader, run_id)
    stored = reader.execute(sa.select(Trace.name, Trace.meta).where(Trace.run_id == run_id)).all()
    flights = [row.name for row in stored]
    labels = list(reader.scalars(sa.select(Finding.label).where(Finding.run_id == run_id)))
    found = bool(labels)
    if runs.campaign(reader, run_id).scenario is not None:
        kinds: tuple[Kind, ...] = (*REPORTS, *FILES, PICTURE, *_capsule(labels), _recording(flights, "flight"))
        return [_file(run, kind, _missing(kind, bool(flights), found)) for kind in kinds]
    drawn = [row.name for row in stored if row.meta.get("scene")]
    recorded = [_recording(drawn, "case")] if drawn else []
    kinds = (*REPORTS, *(SIMULATED.get(kind.file, kind) for kind in FILES), *_capsule(labels), *recorded)
    return [_file(run, kind, _untraced(kind, bool(flights), found)) for kind in kinds]


def _untraced(kind: Kind, traced: bool, found: bool) -> str | None:
    """As `_missing`, of a run that evaluates a simulator."""
    if kind.flights and not traced:
        return "this run has no stored trace"
    return "this run has no finding and no nominal case" if kind.findings and not (traced or found) else None


def _capsule(labels: list[str]) -> list[Kind]:
    """The capsule of the worst finding; those of the others have similar addresses."""
    worst = sorted(labels, key=lambda name: (len(name), name))[:1]
    text = "Everything that evaluates it again without a service (clearance replay FILE), and its view in 3D"
    return [Kind(f"capsule-{label}.zip", f"Finding {label}, capsule", text, "application/zip") for label in worst]


def _recording(flights: list[str], one: str) -> Kind:
    """The recording of the worst stored flight, or case of a simulator; the others have similar addresses."""
    label = min((name for name in flights if name != "nominal"), key=lambda name: (len(name), name), default="nominal")
    title = f"Nominal {one}" if label == "nominal" else f"{one.capitalize()} {label}"
    text = "A recording with a play bar; one file that works offline"
    return Kind(f"flight-{label}.html", f"{title} in 3D, HTML", text, "text/html", flights=True)


def _missing(kind: Kind, traced: bool, found: bool) -> str | None:
    """The reason why the file is not available; None if it is."""
    if kind.flights and not traced:
        return "this run has no stored flight"
    return "this run has no stored flight and no finding" if kind.findings and not (traced or found) else None


def _file(run: RunSummary, kind: Kind, why: str | None) -> ExportFile:
    if kind.media_type == "application/pdf" and pdf.browser() is None:
        why = "needs Chromium on the service's machine"
    why = why or kind.missing()
    place = kind.file.replace("safety-case-report", "report") if kind.report else f"exports/{kind.file}"
    return ExportFile(
        name=named(run.id, run.name, kind.file),
        title=kind.title,
        text=kind.text,
        media_type=kind.media_type,
        href=at(f"/api/v1/runs/{run.id}/{place}"),
        unavailable=why,
    )


def tag(reader: sa.Connection, run_id: int) -> str | None:
    """The entity tag of the run's files (RFC 9110, 8.8.3); None while the run is active.

    It covers everything in them: results, annotations, sign-offs, and the catalogue with its units.
    """
    run = runs.detail(reader, run_id)
    if run.state not in ENDED:
        return None
    published = reader.scalar(sa.select(sa.func.max(CatalogueDocument.published)))
    parts = [run.model_dump_json(), signoffs.listed(reader, run_id).model_dump_json(), str(published)]
    return f'W/"{hashlib.sha256("".join(parts).encode()).hexdigest()}"'


def evaluations_csv(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    """One row for each evaluation of every stage."""
    with read(engine) as reader:
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
    return _evaluations_csv(engine, found)


def _evaluations_csv(engine: sa.Engine, found: Sheet) -> Iterator[bytes]:
    yield _lines([["stage", "kind", "method", *found.columns]])
    for stage in found.stages:
        told = [stage.position, stage.kind, stage.method]
        for block in found.rows(engine, stage):
            yield _lines([told + row for row in block])


def findings_csv(reader: sa.Connection, run_id: int) -> Iterator[bytes]:
    """One row for the nominal case and each finding, with every criterion's value, even without a stored flight.

    The last column has the units of the columns whose headers have none: their names are as scripts know them.
    """
    asked = runs.detail(reader, run_id)
    found = {finding.label: finding for finding in results.findings(reader, run_id)}
    # A simulator's trace shows one call, which may differ from the stored evaluation.
    flies = asked.campaign.get("scenario") is not None
    flights = {flight.name: flight.meta for flight in results.traces(reader, run_id)} if flies else {}
    paths = list(asked.campaign["uncertain"])
    heads = [f"{name} [{unit}]" if unit else name for name, unit in headings(asked.criteria)]
    columns = ["margin", "closest at [s]", "speed there [m/s]", "validated", "found by", *paths, "units"]
    yield _lines([["flight", *heads, *columns]])
    parameters = sheet(reader, run_id, runs.campaign(reader, run_id)).parameters
    units = "; ".join(f"{name} [{unit}]" for name, unit in [("margin", asked.unit), *parameters] if unit)
    nominal = _nominal(reader, run_id)
    for name in dict.fromkeys([*flights, *(["nominal"] if nominal.cost is not None else []), *found]):
        head, finding = flights.get(name), found.get(name)
        cost, of = (finding.cost, finding.parameters) if finding else (nominal.cost, nominal.parameters)
        if head is not None:
            cost, of = head.cost, finding.parameters if finding else head.parameters
        values = head.values if head is not None and head.values else {asked.criteria[0].name: cost}
        told = [values.get(criterion.name) for criterion in asked.criteria]
        margin = None if told[0] is None or asked.threshold is None else told[0] - asked.threshold
        by = " ".join(finding.methods) if finding else ""
        ok = finding.validation.ok if finding and finding.validation else None
        at = [head.closest.time, head.closest.speed] if head is not None and head.closest else [None, None]
        yield _lines([[name, *told, margin, *at, ok, by, *(of.get(p) for p in paths), units]])


def _nominal(reader: sa.Connection, run_id: int) -> NominalResult:
    """The result of the nominal stage; without a cost until the stage is done."""
    first = next(iter(runs.stages(reader, run_id)), None)
    found = None if first is None else first.result
    return found if isinstance(found, NominalResult) else NominalResult(cost=None, margin=None, status=Status.FAILED)


def traces_csv(reader: sa.Connection, run_id: int) -> Iterator[bytes]:
    """All flights in sequence; columns that a flight does not have are empty."""
    flights = results.traces(reader, run_id)
    heads = {c.name: f"{c.name} [{c.unit}]" if c.unit else c.name for flight in flights for c in flight.columns}
    yield _lines([["flight", *heads.values()]])
    for flight in flights:
        row = results.stored(reader, run_id, flight.name)
        data = results.table(row)
        place = {column["name"]: k for k, column in enumerate(row.columns)}
        chosen = [data[:, place[name]].tolist() if name in place else [None] * len(data) for name in heads]
        yield _lines([[flight.name, *map(_finite, values)] for values in zip(*chosen, strict=True)])


def run_json(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    """All data of the run as one JSON document; evaluations are rows, preceded by their column names."""
    with read(engine) as reader:
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
        told = {
            "format": FORMAT,
            "results_digest": results_digest(reader, run_id),
            "run": runs.detail(reader, run_id).model_dump(mode="json"),
            "components": _components(reader, run_id),
            "signoffs": [s.model_dump(mode="json") for s in signoffs.listed(reader, run_id).items],
            "findings": [f.model_dump(mode="json") for f in results.findings(reader, run_id)],
        }
        stages = [s.model_dump(mode="json") for s in runs.stages(reader, run_id)]
        flights = [flight.name for flight in results.traces(reader, run_id)]
    return _run_json(engine, found, told, stages, flights)


def _components(reader: sa.Connection, run_id: int) -> JsonObject | None:
    """The stored component descriptions; None if there are none, since the installed ones may differ."""
    told = snapshots.of_run(reader, run_id) and components(reader, run_id)
    return told.model_dump(mode="json") if told else None


def _run_json(
    engine: sa.Engine, found: Sheet, told: JsonObject, stages: list[JsonObject], flights: list[str]
) -> Iterator[bytes]:
    yield (_text(told)[:-1] + f',"columns":{_text(found.columns)},"stages":[').encode()
    evaluated = {stage.position: stage for stage in found.stages}
    for i, stage in enumerate(stages):
        yield ((",\n" if i else "\n") + _text(stage)[:-1] + ',"rows":[').encode()
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
    for block in found.rows(engine, stage):
        yield (("\n" if first else ",\n") + ",\n".join(map(_text, block))).encode()
        first = False


def traces_mat(reader: sa.Connection, run_id: int) -> bytes:
    """The flights as structures of columns (`nominal.x`, `F1.separation`), with `run`, `units` and `meta`."""
    from scipy.io import savemat  # imported here because it takes a third of a second

    detail = runs.summary(reader, run_id)
    told: JsonObject = {"run": {"id": detail.id, "name": detail.name, "campaign_digest": detail.campaign_digest}}
    for flight in results.traces(reader, run_id):
        row = results.stored(reader, run_id, flight.name)
        data = results.table(row)
        fields: JsonObject = {_field(c["name"]): data[:, [k]] for k, c in enumerate(row.columns)}
        fields["units"] = {_field(c["name"]): c["unit"] for c in row.columns}
        fields["meta"] = _text(row.meta)
        told[_field(flight.name)] = fields
    buffer: Any = io.BytesIO()  # SciPy's type stubs allow only file names
    savemat(buffer, told, long_field_names=True, do_compression=True)
    return bytes(buffer.getvalue())


def _field(name: str) -> str:
    """A valid MATLAB name: obstacle.0.x becomes obstacle_0_x."""
    clean = re.sub(r"\W", "_", name, flags=re.ASCII)[:63]
    return clean if clean[:1].isalpha() else f"c_{clean}"[:63]


def _lines(rows: list[list[Any]]) -> bytes:
    text = io.StringIO()
    Writer(text).writerows(rows)
    return text.getvalue().encode()


def _finite(value: float | None) -> float | None:
    return value if value is not None and abs(value) != float("inf") and value == value else None


def _text(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
