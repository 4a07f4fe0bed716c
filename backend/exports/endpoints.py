"""The export files of a run: their list, and each file."""

from __future__ import annotations

import functools
from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.concurrency import run_in_threadpool

from backend.access.auth import CurrentVisitor
from backend.db.engine import ask
from backend.exports import service
from backend.exports.format import Format, known, named
from backend.exports.service import ExportFile
from backend.http.capacity import BoundedStream
from backend.http.deps import Engine, Reader, account, capacities
from backend.http.errors import RefusedError, Responses, problems
from backend.http.schema import RunName
from backend.runs.service import number

router = APIRouter(tags=["exports"])
Theme = Annotated[Literal["light", "dark"], Query(description="The colour theme of a recording.")]
FileName = Annotated[
    str, Path(max_length=60, description="A file as listed, or that of another finding: capsule-F2.zip")
]
SERVED = [one for one in known() if not one.address]

TAGGED = {
    "ETag": {
        "description": "The entity tag of the file, for `If-None-Match`; absent while the run is active.",
        "schema": {"type": "string"},
    }
}


def _schema(one: Format) -> dict[str, str]:
    if one.media_type == "application/json":
        return {}
    return {"type": "string", "format": "binary"} if one.binary else {"type": "string"}


_ANSWERS: Responses = {
    200: {
        "description": f"One of {', '.join(one.file for one in SERVED)}.",
        "content": {one.media_type: {"schema": _schema(one)} for one in SERVED},
        "headers": TAGGED,
    },
    304: {"description": "The file matches `If-None-Match`.", "headers": TAGGED},
}


@router.get("/runs/{run}/exports", responses=problems("not-found", "other-version", "purged"))
def list_exports(run: RunName, reader: Reader) -> list[ExportFile]:
    """The export files of a run."""
    return service.files(reader, number(run))


@router.get(
    "/runs/{run}/exports/{file}",
    response_class=Response,
    responses=_ANSWERS | problems("not-found", "other-version", "purged", "no-package", "no-space", "busy"),
)
async def export_file(
    run: RunName, file: FileName, request: Request, engine: Engine, visitor: CurrentVisitor, theme: Theme = "light"
) -> Response:
    """One export file of a run; large ones are streamed. The list has those that the run offers.

    A recording and a capsule exist for every finding, a recording also for the nominal flight: `flight-F2.html`,
    `capsule-F2.zip`, `flight-nominal.html`.
    """
    found = named(file)
    if found is None:
        known_as = ", ".join(one.file for one in SERVED)
        raise RefusedError("not-found", f"there is no file {file!r} of a run; there are {known_as}")
    one, label = found
    if one.answer is not None:
        return await one.answer(request, run, label, theme == "dark")
    run_id, files = number(run), capacities(request).files
    headers = await run_in_threadpool(ask, engine, lambda reader: service.headers(reader, run_id, file))
    if service.unchanged(request, headers):
        return Response(status_code=304, headers=headers)
    if (streamed := one.streamed) is not None:
        parts = functools.partial(streamed, engine, run_id)
        return BoundedStream(files, parts, visitor.account, headers=headers, media_type=one.media_type)
    made = one.made
    assert made is not None
    content = await files.run(account(request), lambda: made(engine, run_id), request.is_disconnected)
    return Response(content, headers=headers, media_type=one.media_type)
