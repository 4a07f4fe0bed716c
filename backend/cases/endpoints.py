"""/runs/{run}/cases: one case of a run's simulator with other parameters, and whether that is possible."""

from __future__ import annotations

from functools import partial

from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.cases import service
from backend.cases.schemas import CaseAnswer, CaseInstalled, CaseRequest
from backend.db.engine import read
from backend.flights.drawing import WHAT_IF, drew, in_turn
from backend.flights.turns import Turn
from backend.http.deps import Engine, account, capacities
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.scenes.viewer.viewer import Viewer

router = APIRouter(tags=["results"])


@router.get(
    "/runs/{run}/cases",
    responses=problems("not-found", "other-version", "purged", "not-flyable", "busy", "case-failed"),
)
async def case_installed(run: RunName, request: Request, engine: Engine) -> CaseInstalled:
    """Whether the machine of the service has the simulator of this run, so that its cases can be evaluated there."""

    def looked() -> CaseInstalled:
        with read(engine) as reader:
            wanted = service.simulator(reader, run)
        return service.installed(request.app.state.cases, *wanted)

    return await capacities(request).cases.run(account(request), looked, request.is_disconnected)


@router.post("/runs/{run}/cases", responses=problems(*WHAT_IF, "case-failed"))
async def evaluate_case(
    run: RunName, case: CaseRequest, request: Request, engine: Engine, visitor: CurrentVisitor
) -> CaseAnswer:
    """Evaluate one case of the run's simulator with other parameters (what-if); stores nothing, and is no evidence.

    An evaluation that fails returns 200 with its status and reason. It is a single call, on the machine of the service,
    which must have the run's simulator. Of one client's pending requests only the newest is processed; older ones
    return 409. An evaluation that takes too long is ended with 503.
    """
    work = partial(_work, request, engine, run, case)
    return await in_turn(request, visitor, run, case, capacities(request).cases, work)


def _work(
    request: Request, engine: Engine, run: str, case: CaseRequest, viewer: Viewer | None, turn: Turn
) -> CaseAnswer:
    with read(engine) as reader:
        wanted = service.requested_case(reader, run, case)
    answer = service.evaluated(request.app.state.cases, wanted, case.rows)
    drawn = case.view if drew(viewer, answer, None, turn) else None
    with read(engine) as reader:
        return service.response(reader, wanted, answer, drawn, case.rows)
