"""POST /runs/{run}/flights: one flight of a run with other parameters."""

from __future__ import annotations

import sqlalchemy as sa
from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.flights.case import Case, case, response
from backend.flights.drawing import WHAT_IF, in_turn
from backend.flights.schemas import FlightAnswer, FlightRequest
from backend.http.deps import capacities
from backend.http.errors import RefusedError, problems
from backend.http.schema import RunName
from backend.results.noise import seeds
from backend.runs.service import campaign, number
from backend.scenes.base.flight import ROWS
from backend.scenes.live.live import FlightRefusedError, Live, LiveError
from campaigns.runs import run_name
from campaigns.stored.replies import FlightReply

router = APIRouter(tags=["results"])


@router.post("/runs/{run}/flights", responses=problems(*WHAT_IF, "flight-failed"))
async def simulate_flight(
    run: RunName, flight: FlightRequest, request: Request, visitor: CurrentVisitor
) -> FlightAnswer:
    """Simulate one flight of the run's scenario with other parameters (what-if); stores nothing.

    A flight that fails, or whose start is excluded, returns 200 with its status and reason. With the parameters and
    seed of a finding the cost is bit-identical to the finding's if the run's code is installed; `code_changes` names
    what is not. Of one client's
    pending requests only the newest is processed; older ones return 409.
    """
    return await in_turn(
        request,
        visitor,
        run,
        flight,
        capacities(request).flights,
        lambda reader: _requested(reader, run, flight),
        lambda wanted: _simulated(request.app.state.live, wanted, flight.rows),
        response,
    )


def _requested(reader: sa.Connection, run: str, request: FlightRequest) -> Case:
    """The requested case; raises `RefusedError` for an unknown run, finding or parameter, or a value outside limits."""
    run_id = number(run)
    found = campaign(reader, run_id)
    if found.scenario is None:
        text = f"{run_name(run_id)} evaluates a simulator: it has no flight to simulate"
        raise RefusedError("not-flyable", text)
    seed = request.seed if request.seed is not None else seeds(reader, run_id).get(request.like)
    return case(reader, run_id, found, request.like, request.parameters, seed)


def _simulated(live: Live, wanted: Case, rows: int) -> FlightReply:
    """The answer of the simulation process; raises `RefusedError`."""
    # A drawn flight needs its poses, so a time series is always requested.
    try:
        campaign = wanted.campaign
        return live.simulate(campaign.document(), campaign.digest, wanted.values, max(rows, ROWS), wanted.seed)
    except FlightRefusedError as error:
        raise RefusedError("not-flyable", f"this flight cannot be simulated: {error}") from None
    except LiveError as error:
        raise RefusedError("flight-failed", f"the flight could not be simulated: {error}") from None
