"""/runs/{run}/cases: one case of a run's simulator with other parameters, and whether that is possible."""

from __future__ import annotations

from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.cases import service
from backend.cases.schemas import CaseAnswer, CaseInstalled, CaseRequest
from backend.db.engine import ask
from backend.flights.drawing import WHAT_IF, in_turn
from backend.http.deps import Engine, account, capacities
from backend.http.errors import problems
from backend.http.schema import RunName

router = APIRouter(tags=["results"])


@router.get(
    "/runs/{run}/cases",
    responses=problems("not-found", "other-version", "purged", "not-flyable", "busy", "case-failed"),
)
async def case_installed(run: RunName, request: Request, engine: Engine) -> CaseInstalled:
    """Whether the machine of the service has the simulator of this run, so that its cases can be evaluated there."""

    def looked() -> CaseInstalled:
        wanted = ask(engine, lambda reader: service.simulator(reader, run))
        return service.installed(request.app.state.cases, *wanted)

    return await capacities(request).cases.run(account(request), looked, request.is_disconnected)


@router.post("/runs/{run}/cases", responses=problems(*WHAT_IF, "case-failed"))
async def evaluate_case(run: RunName, case: CaseRequest, request: Request, visitor: CurrentVisitor) -> CaseAnswer:
    """Evaluate one case of the run's simulator with other parameters (what-if); stores nothing, and is no evidence.

    An evaluation that fails returns 200 with its status and reason. It is a single call, on the machine of the service,
    which must have the run's simulator. Of one client's pending requests only the newest is processed; older ones
    return 409. An evaluation that takes too long is ended with 503.
    """
    return await in_turn(
        request,
        visitor,
        run,
        case,
        capacities(request).cases,
        lambda reader: service.requested_case(reader, run, case),
        lambda wanted: service.evaluated(request.app.state.cases, wanted, case.rows),
        service.response,
    )
