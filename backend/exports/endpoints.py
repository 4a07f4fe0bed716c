"""The export files of a run: their list, and each file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal

import sqlalchemy as sa
from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.concurrency import run_in_threadpool

from backend.db.engine import read
from backend.exports import capsules, mcap, parquet, service
from backend.exports.schemas import ExportFile
from backend.http.capacity import BoundedStream
from backend.http.deps import Engine, Reader, capacities
from backend.http.errors import RefusedError, problems
from backend.http.naming import named
from backend.http.schema import FlightName, RunName
from backend.reports import picture
from backend.runs.service import number, summary
from backend.scenes.recordings import pages as recordings
from campaigns.capsules.packing import Content, packed
from campaigns.documents import JsonObject

router = APIRouter(tags=["exports"])
Theme = Annotated[Literal["light", "dark"], Query(description="The colour theme.")]
FindingName = Annotated[str, Path(max_length=20, description="A finding by its label, such as F1.")]
_KINDS = {kind.file: kind for kind in (*service.FILES, service.PICTURE)}

STREAMED = frozenset({"run.json", "evaluations.csv"})
"""Files that are generated while they are sent, because they may be large."""


BINARY = frozenset({"application/x-matlab-data", "application/x-mcap", "application/vnd.apache.parquet"})

TAGGED = {
    "ETag": {
        "description": "The entity tag of the file, for `If-None-Match`; absent while the run is active.",
        "schema": {"type": "string"},
    }
}


def _described(file: str) -> dict[int | str, JsonObject]:
    media = _KINDS[file].media_type
    schema = {} if media == "application/json" else {"type": "string"}
    if media in BINARY:
        schema["format"] = "binary"
    unchanged = {"description": "The file matches `If-None-Match`.", "headers": TAGGED}
    made = {"description": _KINDS[file].text, "content": {media: {"schema": schema}}, "headers": TAGGED}
    return {200: made, 304: unchanged}


_CAPSULE: dict[int | str, JsonObject] = {
    200: {
        "description": "A zip file.",
        "content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}},
        "headers": TAGGED,
    },
    304: {"description": "The file matches `If-None-Match`.", "headers": TAGGED},
}
_RECORDING: dict[int | str, JsonObject] = {
    200: {
        "description": "One self-contained file.",
        "content": {"text/html": {"schema": {"type": "string"}}},
        "headers": TAGGED,
    },
    304: {"description": "The file matches `If-None-Match`.", "headers": TAGGED},
}


@router.get("/runs/{run}/exports", responses=problems("not-found", "purged"))
def list_exports(run: RunName, reader: Reader) -> list[ExportFile]:
    """The export files of a run."""
    return service.files(reader, number(run))


@router.get(
    "/runs/{run}/exports/run.json",
    response_class=Response,
    responses=_described("run.json") | problems("not-found", "other-version", "purged"),
)
async def export_run(run: RunName, request: Request, engine: Engine) -> Response:
    """All data of the run as one JSON document, streamed; `columns` are those of each stage's `rows`."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "run.json", lambda: service.run_json(engine, run_id))


@router.get(
    "/runs/{run}/exports/evaluations.csv",
    response_class=Response,
    responses=_described("evaluations.csv") | problems("not-found", "other-version", "purged"),
)
async def export_evaluations(run: RunName, request: Request, engine: Engine) -> Response:
    """Every evaluation of every stage as CSV (RFC 4180), streamed; the column headers contain the units."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "evaluations.csv", lambda: service.evaluations_csv(engine, run_id))


@router.get(
    "/runs/{run}/exports/findings.csv",
    response_class=Response,
    responses=_described("findings.csv") | problems("not-found", "other-version", "purged"),
)
async def export_findings(run: RunName, request: Request, engine: Engine) -> Response:
    """The nominal case and every finding as CSV, one row each, with the values of all criteria."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "findings.csv", lambda: _whole(engine, run_id, service.findings_csv))


@router.get(
    "/runs/{run}/exports/traces.csv",
    response_class=Response,
    responses=_described("traces.csv") | problems("not-found", "other-version", "purged"),
)
async def export_traces(run: RunName, request: Request, engine: Engine) -> Response:
    """All rows of the stored flights as CSV; the column `flight` identifies the flight."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "traces.csv", lambda: _whole(engine, run_id, service.traces_csv))


@router.get(
    "/runs/{run}/exports/traces.mat",
    response_class=Response,
    responses=_described("traces.mat") | problems("not-found", "other-version", "purged"),
)
async def export_mat(run: RunName, request: Request, engine: Engine) -> Response:
    """The stored flights as a MAT-file of version 5, one structure each."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "traces.mat", lambda: _read(engine, run_id, service.traces_mat))


@router.get(
    "/runs/{run}/exports/worst-case.svg",
    response_class=Response,
    responses=_described("worst-case.svg") | problems("not-found", "other-version", "purged"),
)
async def export_picture(run: RunName, request: Request, engine: Engine) -> Response:
    """The worst case and the nominal flight from above as a picture, for a summary of a CI job."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "worst-case.svg", lambda: _read(engine, run_id, picture.picture))


@router.get(
    "/runs/{run}/exports/traces.mcap",
    response_class=Response,
    responses=_described("traces.mcap") | problems("not-found", "other-version", "purged", "no-package"),
)
async def export_mcap(run: RunName, request: Request, engine: Engine) -> Response:
    """The stored flights as MCAP with messages of Foxglove: pose, trajectory, scene, separation."""
    run_id = number(run)
    return await _answer(request, engine, run_id, "traces.mcap", lambda: _read(engine, run_id, mcap.traces_mcap))


@router.get(
    "/runs/{run}/exports/evaluations.parquet",
    response_class=Response,
    responses=_described("evaluations.parquet") | problems("not-found", "other-version", "purged", "no-package"),
)
async def export_parquet(run: RunName, request: Request, engine: Engine) -> Response:
    """Every evaluation of every stage as Parquet: the columns of evaluations.csv, with units in the schema."""
    run_id = number(run)
    made = partial(parquet.evaluations_parquet, engine, run_id)
    return await _answer(request, engine, run_id, "evaluations.parquet", made)


@router.get(
    "/runs/{run}/exports/capsule-{finding}.zip",
    response_class=Response,
    responses=_CAPSULE | problems("not-found", "other-version", "purged", "busy"),
)
async def export_capsule(run: RunName, finding: FindingName, request: Request, engine: Engine) -> Response:
    """A finding as one file: campaign, components, parameters, trajectories, versions, digests, and its view in 3D.

    `clearance replay FILE` evaluates it again without a service; `flight.html` in it opens offline.
    """
    run_id = number(run)

    def looked() -> tuple[Content, dict[str, str]]:
        with read(engine) as reader:
            found, tag = capsules.content(reader, run_id, finding), service.tag(reader, run_id)
        saved = named(found.origin.run, found.origin.name, f"capsule-{finding}.zip")
        headers = {"Content-Disposition": f'attachment; filename="{saved}"', "Cache-Control": "private, no-cache"}
        return found, headers if tag is None else headers | {"ETag": tag}

    content, headers = await run_in_threadpool(looked)
    if "ETag" in headers and headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    page = await _page_of(request, run_id, finding)
    files = capacities(request).files
    made = await files.run(lambda: packed(replace(content, page=page)), request.is_disconnected)
    return Response(made, headers=headers, media_type="application/zip")


async def _page_of(request: Request, run_id: int, finding: str) -> str:
    """The recording of a finding; empty if nothing of it can be drawn."""
    try:
        recorded = await request.app.state.recordings.page(run_id, finding, gone=request.is_disconnected)
    except RefusedError as error:
        if error.status == 503:
            raise
        return ""
    return "" if isinstance(recorded, str) else str(recorded.html)


@router.get(
    "/runs/{run}/exports/flight-{flight}.html",
    response_class=Response,
    responses=_RECORDING | problems("not-found", "other-version", "purged", "busy"),
)
async def export_flight(run: RunName, flight: FlightName, request: Request, theme: Theme = "light") -> Response:
    """A stored flight and the nominal flight in 3D as one HTML file with a play bar; `flight` is F1 or nominal.

    The file works offline. It shows its parameters at full precision, the criterion, the digests and the versions.
    """
    return await recordings.answer(request, run, flight, dark=theme == "dark", how="attachment")


def _read(engine: sa.Engine, run_id: int, made: Callable[[sa.Connection, int], bytes]) -> bytes:
    with read(engine) as reader:
        return made(reader, run_id)


def _whole(engine: sa.Engine, run_id: int, made: Callable[[sa.Connection, int], Iterator[bytes]]) -> bytes:
    with read(engine) as reader:
        return b"".join(made(reader, run_id))


async def _answer(request: Request, engine: sa.Engine, run_id: int, file: str, made: Any) -> Response:
    """The file with its name and entity tag; 304 if the client has it already."""
    files = capacities(request).files

    def head() -> dict[str, str]:
        with read(engine) as reader:
            tag = service.tag(reader, run_id)
            saved = named(request.path_params["run"], summary(reader, run_id).name, file)
        headers = {"Content-Disposition": f'attachment; filename="{saved}"'}
        return headers if tag is None else headers | {"ETag": tag, "Cache-Control": "private, no-cache"}

    headers = await run_in_threadpool(head)
    if "ETag" in headers and headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    media = _KINDS[file].media_type
    if file in STREAMED:
        return BoundedStream(files, made, headers=headers, media_type=media)
    return Response(await files.run(made, request.is_disconnected), headers=headers, media_type=media)
