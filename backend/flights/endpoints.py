"""POST /runs/{run}/flights: one flight of a run with other parameters."""

from __future__ import annotations

import contextlib
from functools import partial

from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.db.engine import read
from backend.flights import service
from backend.flights.schemas import FlightAnswer, FlightRequest
from backend.flights.turns import Turn, Turns
from backend.http.deps import Engine, capacities
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.runs.service import number
from backend.scenes.base.flight import from_live
from backend.scenes.control.viewers import Handle
from backend.scenes.viewer.viewer import GoneError, Viewer

router = APIRouter(tags=["results"])


@router.post(
    "/runs/{run}/flights",
    responses=problems(
        "not-found",
        "flight-overtaken",
        "other-version",
        "purged",
        "unknown-finding",
        "unknown-parameter",
        "outside-limits",
        "not-flyable",
        "busy",
        "flight-failed",
    ),
)
async def simulate_flight(
    run: RunName, given: FlightRequest, request: Request, engine: Engine, visitor: CurrentVisitor
) -> FlightAnswer:
    """Simulate one flight of the run's scenario with other parameters (what-if); stores nothing.

    A flight that fails, or whose start is excluded, returns 200 with its status and reason. With the parameters and
    seed of a finding the cost is bit-identical to the finding's if the run's version is installed. Of one client's
    pending requests only the newest is processed; older ones return 409.
    """
    turns: Turns = request.app.state.turns
    viewer = None
    if given.view is not None:
        viewer = await request.app.state.viewers.find(Handle(visitor, number(run), given.view), 0.0)
    client = (visitor.key, run, given.client or given.view)
    work = partial(_work, request, engine, run, given, viewer)
    return await turns.run(client, capacities(request).flights, work, request.is_disconnected)


def _work(
    request: Request, engine: Engine, run: str, given: FlightRequest, viewer: Viewer | None, turn: Turn
) -> FlightAnswer:
    """In a thread: read, simulate, draw."""
    with read(engine) as reader:
        wanted = service.case(reader, run, given)
    answer = service.simulated(request.app.state.live, wanted, given.rows)
    drawn = None
    if viewer is not None and not turn.overtaken.is_set():
        flight = from_live(answer)
        with contextlib.suppress(GoneError):  # the view was closed meanwhile; the answer is valid without it
            viewer.show_what_if(flight, wanted.seed, turn.order)
            drawn = given.view
    return service.response(wanted, answer, drawn, given.rows)
