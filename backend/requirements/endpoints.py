"""The matrix of requirements and runs, import and export."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import sqlalchemy as sa
from fastapi import APIRouter, Path, Query, Request, Response, status
from fastapi.concurrency import run_in_threadpool

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.catalog.installation import installation
from backend.db import codes
from backend.db.engine import ask, chunks, now
from backend.db.tables import Run
from backend.http.deps import Engine, Reader, account, capacities
from backend.http.errors import answers, problems
from backend.http.matches import TAGGED, IfMatch
from backend.http.naming import disposition
from backend.requirements import gsn, matrix, reqif, service, sheet, uploads
from backend.requirements.schemas import (
    FileKind,
    Imported,
    RequirementFileOut,
    RequirementGiven,
    RequirementPage,
    RequirementRow,
)
from campaigns.asked.values import Name
from campaigns.runs import run_number
from campaigns.version import VERSION

router = APIRouter(tags=["requirements"])

FILE_BODY = {
    "required": True,
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}
RUNS = 3
"""Runs of a requirement on a page, besides those that count."""
RUNS_EXPORTED = 1000
"""The same in the exported matrix."""
FileNumber = Annotated[int, Path(ge=1, le=2**31 - 1, description="The number of the file.")]
Attribute = Annotated[str, Query(max_length=120)]


@router.get("/requirements", responses=problems("bad-cursor"))
def list_requirements(
    reader: Reader,
    q: Annotated[str, Query(max_length=200, description="Words in the id or the text.")] = "",
    cursor: Annotated[str | None, Query(max_length=1000, description="`next_cursor` of the previous page.")] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="Maximum number of requirements on a page.")] = 100,
    runs: Annotated[int, Query(ge=0, le=200, description="Runs of each, besides those that count.")] = RUNS,
) -> RequirementPage:
    """The matrix of requirements and runs, in pages by id. A requirement without a run is a row."""
    return matrix.page(reader, q, cursor, limit, runs)


@router.put("/requirements", responses=TAGGED | problems("requirement-conflict", "changed"))
def write_requirement(
    requirement: RequirementGiven, response: Response, engine: Engine, visitor: CurrentVisitor, match: IfMatch = None
) -> RequirementRow:
    """Add a requirement, or change the text of one; 409 for one of a ReqIF file."""
    row = service.write(engine, requirement, visitor, match)
    response.headers["ETag"] = row.etag
    return row


@router.delete(
    "/requirements",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=problems("not-found", "requirement-conflict", "changed"),
)
def delete_requirement(
    engine: Engine,
    visitor: CurrentVisitor,
    requirement: Annotated[str, Query(max_length=120, description="Its id.")],
    match: IfMatch = None,
) -> None:
    """Delete a requirement; if a run states it, it stays a row of the matrix. 409 for one of a ReqIF file."""
    service.delete(engine, requirement, visitor, match)


@router.get("/requirements/files")
def list_imports(reader: Reader) -> list[RequirementFileOut]:
    """The imported files."""
    return service.files(reader)


@router.post(
    "/requirements/files",
    status_code=status.HTTP_201_CREATED,
    openapi_extra={"requestBody": FILE_BODY},
    responses=problems("unreadable", "requirement-conflict", "busy", *ONCE),
)
async def import_requirements(
    request: Request,
    once: OnceOnly,
    visitor: CurrentVisitor,
    kind: Annotated[FileKind, Query(description="What the file is.")],
    name: Annotated[Name, Query(description="Its name; a later import under the same name replaces it.")],
    id_attribute: Annotated[Attribute, Query(description="The attribute or column with the ids.")] = "",
    text_attribute: Annotated[Attribute, Query(description="The attribute or column with the texts.")] = "",
) -> Imported:
    """Import a CSV or ReqIF file, the body; all of it or nothing."""
    body = await request.body()
    found, skipped = await capacities(request).imports.run(
        account(request), lambda: uploads.read(kind, body, id_attribute, text_attribute), request.is_disconnected
    )
    upload = service.Upload(name, kind, body, found, skipped)
    return await run_in_threadpool(
        once.do,
        Imported,
        lambda writer: service.import_file(writer, upload, visitor),
        lambda _: f"the import of {name!r}",
    )


@router.delete("/requirements/files/{file}", status_code=status.HTTP_204_NO_CONTENT, responses=problems("not-found"))
def delete_import(file: FileNumber, engine: Engine, visitor: CurrentVisitor) -> None:
    """Delete an imported file and its requirements; those that runs state stay rows of the matrix."""
    service.delete_file(engine, file, visitor)


@router.get(
    "/requirements/files/{file}/content",
    response_class=Response,
    responses=answers("The file.", "application/octet-stream") | problems("not-found"),
)
def get_import(file: FileNumber, reader: Reader) -> Response:
    """An imported file, byte by byte as it was."""
    name, kind, content = service.content(reader, file)
    return Response(content, headers=_saved(name), media_type="text/csv" if kind == "csv" else "application/xml")


@router.get(
    "/requirements/export/requirements.csv",
    response_class=Response,
    responses=answers("Id, text, status and attributes.", "text/csv") | problems("busy"),
)
async def export_texts(request: Request, engine: Engine) -> Response:
    """All requirements with their status as CSV."""
    made = await _whole(request, engine, lambda reader: b"".join(sheet.requirements(matrix.every(reader, 0))))
    return Response(made, headers=_saved("requirements.csv"), media_type="text/csv")


@router.get(
    "/requirements/export/matrix.csv",
    response_class=Response,
    responses=answers("A line for each requirement and run.", "text/csv") | problems("busy"),
)
async def export_matrix(request: Request, engine: Engine) -> Response:
    """The matrix as CSV: a line for each requirement and run, one for a requirement without a run."""
    made = await _whole(request, engine, lambda reader: b"".join(sheet.matrix(matrix.every(reader, RUNS_EXPORTED))))
    return Response(made, headers=_saved("matrix.csv"), media_type="text/csv")


@router.get(
    "/requirements/export/requirements.reqif",
    response_class=Response,
    responses=answers("A ReqIF file.", "application/xml") | problems("busy"),
)
async def export_reqif(request: Request, engine: Engine) -> Response:
    """All requirements as one ReqIF file, with their status; an imported file is at its own address, unchanged."""

    def made(reader: sa.Connection) -> bytes:
        rows = ((row.id, row.text, row.status, row.sentence) for row in matrix.every(reader, 0))
        return reqif.write(rows, now(reader), f"Clearance {VERSION}")

    content = await _whole(request, engine, made)
    return Response(content, headers=_saved("requirements.reqif"), media_type="application/xml")


@router.get(
    "/requirements/export/argument.gsn.yaml",
    response_class=Response,
    responses=answers("The argument in Goal Structuring Notation.", "application/yaml") | problems("busy"),
)
async def export_argument(request: Request, engine: Engine) -> Response:
    """The argument as YAML in Goal Structuring Notation, for gsn2x: every leaf with claim, digest and link."""
    settings = request.app.state.settings
    address = settings.public_url.rstrip("/") or str(request.base_url).rstrip("/")

    def made(reader: sa.Connection) -> str:
        rows = list(matrix.every(reader, 0))
        code = None if installation(reader).catalogue is None else codes.published(reader)
        return gsn.argument(rows, _claims(reader, rows), address, now(reader), code)

    text = await _whole(request, engine, made)
    return Response(text, headers=_saved("argument.gsn.yaml"), media_type="application/yaml")


def _claims(reader: sa.Connection, rows: list[RequirementRow]) -> dict[str, str]:
    names = {run.id for row in rows for run in row.runs}
    found: dict[int, str] = {}
    for some in chunks(run_number(name) or 0 for name in names):
        of = sa.select(Run.id, Run.reason).where(Run.id.in_(some))
        found |= {row.id: row.reason or "" for row in reader.execute(of)}
    return {name: found.get(run_number(name) or 0, "") for name in names}


async def _whole(request: Request, engine: sa.Engine, made: Callable[[sa.Connection], Any]) -> Any:
    return await capacities(request).files.run(account(request), lambda: ask(engine, made), request.is_disconnected)


def _saved(name: str) -> dict[str, str]:
    return {"Content-Disposition": disposition("attachment", name)}
