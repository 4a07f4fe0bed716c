"""A run's evaluations, findings and traces."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from backend.http.deps import Reader
from backend.http.errors import problems
from backend.http.schema import FlightName, RunName
from backend.results import evaluations, service
from backend.results.coverage import read as coverage
from backend.results.coverage.schemas import Coverage
from backend.results.schemas import Evaluations, FindingDetail, TraceData, TraceInfo
from backend.runs.service import number

router = APIRouter(tags=["results"])


@router.get("/runs/{run}/evaluations", responses=problems("not-found", "other-version", "purged"))
def get_evaluations(
    run: RunName,
    reader: Reader,
    max_points: Annotated[int, Query(ge=2, le=100_000, description="At most so many evaluations of a stage.")] = 2000,
    position: Annotated[int | None, Query(ge=0, le=1000, description="Only the stage at this position.")] = None,
) -> Evaluations:
    """The evaluations of a run, thinned for charts, improvements of the best first."""
    return evaluations.read(reader, number(run), max_points, position)


@router.get("/runs/{run}/coverage", responses=problems("not-found", "other-version", "purged"))
def get_coverage(run: RunName, reader: Reader) -> Coverage:
    """How much of the box of the bounds the evaluations of a run cover; computed at every request, and no proof."""
    return coverage.read(reader, number(run))


@router.get("/runs/{run}/findings", responses=problems("not-found", "other-version", "purged"))
def list_findings(run: RunName, reader: Reader) -> list[FindingDetail]:
    """The distinct worst cases of a run, the lowest first."""
    return service.findings(reader, number(run))


@router.get("/runs/{run}/traces", responses=problems("not-found", "other-version", "purged"))
def list_traces(run: RunName, reader: Reader) -> list[TraceInfo]:
    """The stored flights of a run: the nominal one and one for each finding."""
    return service.traces(reader, number(run))


@router.get("/runs/{run}/traces/{name}", responses=problems("not-found", "other-version", "purged"))
def get_trace(
    run: RunName,
    name: FlightName,
    reader: Reader,
    max_points: Annotated[int, Query(ge=10, le=100_000, description="At most so many rows.")] = 1000,
) -> TraceData:
    """One trace as columns, thinned, including the rows around the closest approach."""
    return service.trace(reader, number(run), name, max_points)
