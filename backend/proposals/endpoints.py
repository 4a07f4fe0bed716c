"""GET /simulators/{name}/proposal: search methods and budgets that fit the measured time of an evaluation."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from backend.http.deps import Reader
from backend.http.errors import problems
from backend.proposals import service
from backend.proposals.schemas import Proposal

router = APIRouter(tags=["catalog"])

LONGEST = 366 * 86_400.0
"""Of a time for searches [s]."""


@router.get("/simulators/{name}/proposal", responses=problems("not-found", "no-catalogue"))
def propose_searches(
    reader: Reader,
    name: Annotated[str, Path(description="The name of a simulator, such as `drop`.")],
    parameters: Annotated[int, Query(ge=1, le=64, description="Number of uncertain parameters.")],
    patience: Annotated[float, Query(gt=0, le=LONGEST, description="Time for all searches [s].")] = 3600.0,
    calls: Annotated[int, Query(ge=1, le=1000, description="Calls of the simulator for each evaluation.")] = 1,
) -> Proposal:
    """Propose search methods and budgets for a simulator, from what its evaluations took when last measured."""
    return service.proposal(reader, name, parameters, patience, calls)
