"""/runs/{run}/cases: one case of a run's simulator with other parameters, and whether that is possible.

Simulators are code of the operator, so that they run in a child process of the service, as flights do, which evaluates
in processes of its own. The service's machine must have the simulator of the run.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import sqlalchemy as sa
from fastapi import APIRouter, Request

from backend.access.auth import CurrentVisitor
from backend.cases.schemas import CaseAnswer, CaseInstalled, CaseRequest
from backend.db.engine import read
from backend.db.tables import Run
from backend.flights import case as flights
from backend.flights.case import Case
from backend.flights.drawing import WHAT_IF, in_turn
from backend.http.deps import Engine, account, capacities
from backend.http.errors import RefusedError, problems
from backend.http.schema import RunName
from backend.runs.service import campaign, number
from backend.scenes.base.flight import ROWS
from backend.scenes.live.live import FlightRefusedError, Live, LiveError
from campaigns import Campaign
from campaigns.runs import run_name
from campaigns.stored.replies import CaseReply, InstalledReply

router = APIRouter(tags=["results"])

COMMAND = (sys.executable, "-P", "-m", "worker.running.processes.cases")
LIMIT = 60.0
"""Time limit of an evaluation [s]."""
FIRST_LIMIT = 120.0
"""Time limit of a simulator's first evaluation [s], which includes its start and may be repeated."""
GRACE = 2.0
"""Time for the processes to end, with all that they started [s]."""


@router.get(
    "/runs/{run}/cases",
    responses=problems("not-found", "other-version", "purged", "not-flyable", "busy", "case-failed"),
)
async def case_installed(run: RunName, request: Request, engine: Engine) -> CaseInstalled:
    """Whether the machine of the service has the simulator of this run, so that its cases can be evaluated there."""

    def looked() -> CaseInstalled:
        with read(engine) as reader:
            wanted = simulator(reader, run)
        return installed(request.app.state.cases, *wanted)

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
        lambda reader: requested_case(reader, run, case),
        lambda wanted: evaluated(request.app.state.cases, wanted, case.rows),
        response,
    )


def process() -> Live:
    return Live(COMMAND, LIMIT, FIRST_LIMIT, GRACE)


def requested_case(reader: sa.Connection, run: str, request: CaseRequest) -> Case:
    """The requested case; raises `RefusedError` for an unknown run, finding or parameter, or a value outside limits."""
    found, version = simulator(reader, run)
    wanted = flights.case(reader, number(run), found, request.like, request.parameters)
    return replace(wanted, simulator=version)


def simulator(reader: sa.Connection, run: str) -> tuple[Campaign, str]:
    """The campaign of a run that evaluates a simulator, and the version that it needs. Raises `RefusedError`."""
    found = campaign(reader, number(run))
    if found.simulator is None:
        name = run_name(number(run))
        text = f"{name} simulates a scenario: ask for a flight, POST /runs/{name}/flights"
        raise RefusedError("not-flyable", text)
    return found, reader.scalar(sa.select(Run.needs).where(Run.id == number(run))) or ""


def installed(live: Live, campaign: Campaign, version: str) -> CaseInstalled:
    """Whether the machine of the service has this simulator; evaluates nothing. Raises `RefusedError`."""
    request = {"kind": "installed", "campaign": campaign.document(), "simulator": version}
    try:
        found: InstalledReply = live.ask(f"installed {campaign.digest}", request)
    except LiveError as error:
        text = f"whether the simulator is installed could not be found out: {error}"
        raise RefusedError("case-failed", text) from None
    return CaseInstalled(installed=not found["missing"], reason=found["missing"])


def evaluated(live: Live, wanted: Case, rows: int) -> CaseReply:
    """The answer of the process; raises `RefusedError`."""
    request = {"campaign": wanted.campaign.document(), "simulator": wanted.simulator, "parameters": wanted.values}
    try:
        found: CaseReply = live.ask(wanted.campaign.digest, request | {"rows": max(rows, ROWS)})
        return found
    except FlightRefusedError as error:
        raise RefusedError("not-flyable", f"this case cannot be evaluated: {error}") from None
    except LiveError as error:
        text = (
            f"the case could not be evaluated: {error}. The service waits {LIMIT:g} s, and {FIRST_LIMIT:g} s for the "
            "first one"
        )
        raise RefusedError("case-failed", text) from None


def response(reader: sa.Connection, wanted: Case, answer: CaseReply, drawn: str | None, rows: int) -> CaseAnswer:
    plain = flights.response(reader, wanted, answer, drawn, rows if answer["columns"] else 0)
    return CaseAnswer(**plain.model_dump(), seconds=answer["seconds"], untraced=answer["untraced"])
