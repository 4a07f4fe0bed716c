"""Validates a what-if request of a simulator, evaluates it and builds the response.

Simulators are code of the operator, so that they run in a child process of the service, as flights do, which evaluates
in processes of its own. The service's machine must have the simulator of the run.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import sqlalchemy as sa

from backend.cases.schemas import CaseAnswer, CaseInstalled, CaseRequest
from backend.db.tables import Run
from backend.flights import case as flights
from backend.flights.case import Case
from backend.http.errors import RefusedError
from backend.runs.service import campaign, number
from backend.scenes.base.flight import ROWS
from backend.scenes.live.live import FlightRefusedError, Live, LiveError
from campaigns import Campaign
from campaigns.runs import run_name
from campaigns.stored.replies import CaseReply, InstalledReply

COMMAND = (sys.executable, "-P", "-m", "worker.running.processes.cases")
LIMIT = 60.0
"""Time limit of an evaluation [s]."""
FIRST_LIMIT = 120.0
"""Time limit of a simulator's first evaluation [s], which includes its start and may be repeated."""
GRACE = 2.0
"""Time for the processes to end, with all that they started [s]."""


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
