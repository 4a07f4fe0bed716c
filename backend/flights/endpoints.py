"""POST /runs/{run}/flights: one flight of a run with other parameters."""

from __future__ import annotations

from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.flights import service
from backend.flights.case import response
from backend.flights.drawing import WHAT_IF, in_turn
from backend.flights.schemas import FlightAnswer, FlightRequest
from backend.http.deps import capacities
from backend.http.errors import problems
from backend.http.schema import RunName

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
        lambda reader: service.requested_case(reader, run, flight),
        lambda wanted: service.simulated(request.app.state.live, wanted, flight.rows),
        response,
    )
