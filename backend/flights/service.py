"""Reads a what-if request of a scenario and simulates it."""

from __future__ import annotations

import sqlalchemy as sa

from backend.flights.case import Case, case
from backend.flights.schemas import FlightRequest
from backend.http.errors import RefusedError
from backend.results.noise import seeds
from backend.runs.service import campaign, number
from backend.scenes.base.flight import ROWS
from backend.scenes.live.live import FlightRefusedError, Live, LiveError
from campaigns.runs import run_name
from campaigns.stored.replies import FlightReply


def requested_case(reader: sa.Connection, run: str, request: FlightRequest) -> Case:
    """The requested case; raises `RefusedError` for an unknown run, finding or parameter, or a value outside limits."""
    run_id = number(run)
    found = campaign(reader, run_id)
    if found.scenario is None:
        text = f"{run_name(run_id)} evaluates a simulator: it has no flight to simulate"
        raise RefusedError("not-flyable", text)
    seed = request.seed if request.seed is not None else seeds(reader, run_id).get(request.like)
    return case(reader, run_id, found, request.like, request.parameters, seed)


def simulated(live: Live, wanted: Case, rows: int) -> FlightReply:
    """The answer of the simulation process; raises `RefusedError`."""
    # A drawn flight needs its poses, so a time series is always requested.
    try:
        campaign = wanted.campaign
        return live.simulate(campaign.document(), campaign.digest, wanted.values, max(rows, ROWS), wanted.seed)
    except FlightRefusedError as error:
        raise RefusedError("not-flyable", f"this flight cannot be simulated: {error}") from None
    except LiveError as error:
        raise RefusedError("flight-failed", f"the flight could not be simulated: {error}") from None
