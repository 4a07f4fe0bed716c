"""GET /runs/{run}/most-likely-violation and POST /runs/{run}/reweighted: a run under its distributions, and others."""

from __future__ import annotations

from fastapi import APIRouter

from backend.http.deps import Reader
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.likelihood import service
from backend.likelihood.schemas import ReweightRequest
from backend.results import likely
from backend.runs.service import number
from campaigns.results.likelihood import MostLikely
from campaigns.results.reweighted import Reweighted

router = APIRouter(tags=["results"])


@router.post(
    "/runs/{run}/reweighted",
    responses=problems("not-found", "other-version", "purged", "unknown-parameter", "invalid-request"),
)
def reweight_sample(run: RunName, moved: ReweightRequest, reader: Reader) -> Reweighted:
    """Estimate P(violation) and quantiles under other distributions by re-weighting the run's independent sample.

    Nothing is evaluated or stored. An estimate that cannot be made returns 200 without numbers; `text` has the reason.
    """
    return service.estimated(reader, number(run), moved)


@router.get("/runs/{run}/most-likely-violation", responses=problems("not-found", "other-version", "purged"))
def get_most_likely(run: RunName, reader: Reader) -> MostLikely:
    """The most likely of the violations that a run evaluated, under the stated distributions; computed when read."""
    return likely.violation(reader, number(run))
