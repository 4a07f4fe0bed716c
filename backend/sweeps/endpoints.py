"""POST and GET /sweeps, one sweep, its table, cancellation."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Request, Response, status
from fastapi.concurrency import run_in_threadpool

from backend.access.auth import CurrentVisitor
from backend.http import bodies
from backend.http.deps import ROOM, Engine, Reader, account, capacities
from backend.http.errors import RefusedError, answers, located, problems
from backend.http.keys import Key
from backend.http.root import at
from backend.sweeps import service, sheet
from backend.sweeps.schemas import SweepDetail, SweepSubmit, SweepSummary
from campaigns.asked.load import load_document

router = APIRouter(tags=["sweeps"])

SweepName = Annotated[str, Path(description="The sweep by its name, such as S-0001.")]
LOCATION = located("The sweep that was launched, now or earlier with the same key.", "sweep")


@router.post(
    "/sweeps",
    status_code=status.HTTP_201_CREATED,
    openapi_extra=bodies.of("SweepSubmit", yaml=False),
    dependencies=ROOM,
    responses=LOCATION | problems(*bodies.LAUNCH),
)
async def submit_sweep(
    request: Request, response: Response, engine: Engine, visitor: CurrentVisitor, key: Key = None
) -> SweepDetail:
    """Queue one run for each value of a fixed parameter; all of them, or none if one is invalid."""
    if bodies.content_type(request) not in bodies.JSON_TYPES:
        raise RefusedError("unsupported-media-type", "send a sweep as application/json: campaign, path, values")
    body = await request.body()
    submission = await capacities(request).bodies.run(account(request), lambda: _submission(body))
    sweep = await run_in_threadpool(service.submit, engine, submission, visitor, key, request.app.state.quota)
    response.headers["Location"] = at(f"{request.url.path}/{sweep.id}")
    return sweep


@router.get("/sweeps")
def list_sweeps(
    reader: Reader, limit: Annotated[int, Query(ge=1, le=200, description="Maximum number of sweeps.")] = 50
) -> list[SweepSummary]:
    """The newest sweeps, newest first."""
    return service.listed(reader, limit)


@router.get("/sweeps/{sweep}", responses=problems("not-found"))
def get_sweep(sweep: SweepName, reader: Reader) -> SweepDetail:
    """One sweep: its values in ascending order, with the outcome of each run."""
    return service.detail(reader, service.number(sweep))


@router.get(
    "/sweeps/{sweep}/table.csv",
    response_class=Response,
    responses=answers("One row for each run.", "text/csv") | problems("not-found"),
)
def get_sweep_table(sweep: SweepName, reader: Reader) -> Response:
    """The sweep as CSV (RFC 4180); numbers that were not computed are empty."""
    found = service.detail(reader, service.number(sweep))
    headers = {"Content-Disposition": f'attachment; filename="{found.id}.csv"'}
    return Response(sheet.csv_of(found), headers=headers, media_type="text/csv")


@router.post("/sweeps/{sweep}/cancel", responses=problems("not-found"))
def cancel_sweep(sweep: SweepName, engine: Engine, visitor: CurrentVisitor) -> SweepDetail:
    """Cancel all runs of a sweep; those that have ended are unchanged."""
    return service.cancel(engine, service.number(sweep), visitor)


def _submission(body: bytes) -> service.Submission:
    options = bodies.described(body, SweepSubmit)
    return service.Submission(load_document(options.campaign, "request"), options, body)
