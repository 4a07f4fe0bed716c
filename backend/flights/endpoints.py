"""POST /runs/{run}/flights: one flight of a run with other parameters."""

from __future__ import annotations

from functools import partial

from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.db.engine import read
from backend.flights import service
from backend.flights.case import response
from backend.flights.drawing import WHAT_IF, drew, in_turn
from backend.flights.schemas import FlightAnswer, FlightRequest
from backend.flights.turns import Turn
from backend.http.deps import Engine, capacities
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.scenes.viewer.viewer import Viewer

router = APIRouter(tags=["results"])


@router.post("/runs/{run}/flights", responses=problems(*WHAT_IF, "flight-failed"))
async def simulate_flight(
    run: RunName, flight: FlightRequest, request: Request, engine: Engine, visitor: CurrentVisitor
) -> FlightAnswer:
    """Simulate one flight of the run's scenario with other parameters (what-if); stores nothing.

    A flight that fails, or whose start is excluded, returns 200 with its status and reason. With the parameters and
    seed of a finding the cost is bit-identical to the finding's if the run's code is installed; `code_changes` names
    what is not. Of one client's
    pending requests only the newest is processed; older ones return 409.
    """
    work = partial(_work, request, engine, run, flight)
    return await in_turn(request, visitor, run, flight, capacities(request).flights, work)


def _work(
    request: Request, engine: Engine, run: str, flight: FlightRequest, viewer: Viewer | None, turn: Turn
) -> FlightAnswer:
    with read(engine) as reader:
        wanted = service.requested_case(reader, run, flight)
    answer = service.simulated(request.app.state.live, wanted, flight.rows)
    drawn = flight.view if drew(viewer, answer, wanted.seed, turn) else None
    with read(engine) as reader:
        return response(reader, wanted, answer, drawn, flight.rows)
