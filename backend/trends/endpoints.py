"""GET /runs/{run}/related, and /trends of a campaign."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import Field

from backend.http.deps import Reader
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.runs.filters import labelled
from backend.runs.service import number
from backend.trends import service
from backend.trends.schemas import RelatedRuns, Trend

router = APIRouter(tags=["runs"])


@router.get("/runs/{run}/related", responses=problems("not-found", "purged"))
def list_related(run: RunName, reader: Reader) -> RelatedRuns:
    """Other runs with the same campaign, and those that differ in one thing: the seed or the code."""
    return service.related(reader, number(run))


@router.get("/trends", responses=problems("not-found"))
def get_trend(
    reader: Reader,
    campaign: Annotated[str | None, Query(max_length=64, description="A campaign by its digest.")] = None,
    name: Annotated[str | None, Query(max_length=120, description="All campaigns of this name.")] = None,
    label: Annotated[
        list[Annotated[str, Field(max_length=300)]] | None,
        Query(max_length=50, description="Labels as KEY=VALUE: alternatives of one key, every key required."),
    ] = None,
    limit: Annotated[int, Query(ge=1, le=500, description="Maximum number of runs, the newest.")] = 200,
) -> Trend:
    """The runs of a campaign in time: verdicts, worst margins, probability bounds, and changes of the code."""
    return service.trend(reader, campaign, name, limit, labelled(label or ()))
