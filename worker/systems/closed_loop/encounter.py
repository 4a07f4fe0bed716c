"""Evidence that the nominal case is an encounter: closest approach, path length, and the same case without avoidance.

Start reading at `shown`.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from backend.db.records import Trace
from campaigns import Campaign
from campaigns.asked.scenario import FaultPart
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Unseen
from worker.systems.base import Condition, Shown
from worker.systems.closed_loop.assemble import Loop
from worker.systems.closed_loop.flights import Flights
from worker.systems.closed_loop.trace import trace

UNSEEN = FaultPart(component="blackout", parameters={"at": 0.0, "duration": 1e6})
"""No obstacle is ever seen: the avoider steers to the goal as if there were none."""

KEPT = 8
"""How many unseen flights are kept of each loop."""

_FLOWN: WeakKeyDictionary[Loop, dict[tuple[str, int | None], Trace]] = WeakKeyDictionary()


def conditions(flights: Flights) -> tuple[Condition, ...]:
    """The available evidence: only criteria on obstacles have a closest approach."""
    near: tuple[Condition, ...] = ("closest approach",) if flights.parts.criterion.of == "obstacles" else ()
    return (*near, "motion", "avoidance")


def shown(flights: Flights, nominal: Trace) -> Shown:
    """The evidence for the nominal case with this trace; simulates one more case in plain Python."""
    return Shown(
        ClosestApproach.of(nominal.meta.closest, len(nominal.data)), _moved(nominal), _unseen(flights.campaign, nominal)
    )


def _moved(flight: Trace) -> float | None:
    """The length of the path [m]; None for a trace without rows."""
    path = flight.data[:, 1:4]
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) if len(path) else None


def _unseen(campaign: Campaign, nominal: Trace) -> Unseen:
    """The nominal case with an avoider that sees nothing, one simulation in plain Python: its cost, and the largest
    distance between the two paths at one instant [m]."""
    realisation = nominal.meta.realisation
    blind = Flights(unseen(campaign), compiled=False, lanes=1)
    # With several realisations, use the one that the nominal trace shows: the worst, which determines the cost.
    flight = _flown(blind, None if realisation is None else realisation.seed)
    rows = min(len(flight.data), len(nominal.data))
    apart = np.linalg.norm(flight.data[:rows, 1:4] - nominal.data[:rows, 1:4], axis=1)
    return Unseen(
        cost=flight.meta.cost,
        status=flight.meta.status,
        reason=flight.meta.reason,
        deviation=float(apart.max()) if rows else None,
    )


def _flown(blind: Flights, seed: int | None) -> Trace:
    """That simulation; those of the last loops are kept, because a process often runs a scenario again."""
    campaign = blind.campaign
    asked = (campaign.given_scenario, campaign.criterion, campaign.objectives)
    key = repr(asked), seed
    kept = _FLOWN.setdefault(blind.loop, {})
    if key not in kept:
        if len(kept) >= KEPT:
            kept.clear()
        kept[key] = trace(blind.under(seed), "unseen", {})
    return kept[key]


def unseen(campaign: Campaign) -> Campaign:
    """The campaign with all obstacles hidden from the avoider."""
    scenario = campaign.given_scenario
    return campaign.model_copy(update={"scenario": scenario.model_copy(update={"faults": [*scenario.faults, UNSEEN]})})
