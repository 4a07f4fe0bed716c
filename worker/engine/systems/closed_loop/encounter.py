"""Evidence that the nominal case is an encounter: closest approach, path length, and the case without avoidance."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from campaigns import Campaign
from campaigns.asked.scenario import FaultPart
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Unseen
from campaigns.stored.records import Trace
from worker.engine.kernels.component import Environment, Fault
from worker.engine.kernels.reaches import sampled
from worker.engine.systems.base import Floats, Shown
from worker.engine.systems.closed_loop.distances import in_flights
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.trace import trace

UNSEEN = FaultPart(component="blackout", parameters={"at": 0.0, "duration": 1e6})
"""No obstacle is ever seen: the avoider steers to the goal as if there were none."""


def shown(flights: Flights, nominal: Trace) -> Shown:
    """The evidence for the nominal case with this trace; simulates one more case in plain Python."""
    return Shown(
        ClosestApproach.of(nominal.meta.approach, len(nominal.data)),
        _moved(nominal),
        _unseen(flights.campaign, flights.installed, nominal),
        in_flights(flights),
        late(flights),
    )


def late(flights: Flights) -> dict[str, tuple[float, float]]:
    """By path, the earliest and the latest instant at which a fault or the environment first changes [s], by the
    switches that it declares, of those for which the latest is after the horizon, or both are at its end: at the ends
    and corners of its own bounds, and some values within."""
    found, uncertain, horizon = {}, flights.campaign.uncertain, flights.campaign.given_scenario.horizon
    for prefix, part in flights.parts.named.items():
        if not isinstance(part, Fault | Environment) or part.switches is None:
            continue
        at, paths = flights.loop.extended[prefix], {path for path in flights.paths if path.startswith(f"{prefix}.")}
        nominal = {path: float(flights.nominal[flights.paths[path]]) for path in paths}
        bounds = {path: uncertain[path].interval(nominal[path]) for path in paths & uncertain.keys()}
        rows = (flights.loop.extend(flights.vector(values)) for values in sampled(nominal, bounds))
        switches = [[*part.switches(at.fields(*p[at.first : at.last]), horizon)] for p in rows]
        begins = [min(each) for each in switches if each]
        first, last = (min(begins), max(begins)) if len(begins) == len(switches) else (0.0, max(begins, default=0.0))
        if last > horizon or first == horizon:
            found[prefix] = (first, last)
    return found


def _moved(flight: Trace) -> float | None:
    """The length of the path [m]; None for a trace without rows."""
    path = flight.data[:, 1:4]
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) if len(path) else None


def _unseen(campaign: Campaign, installed: Installed, nominal: Trace) -> Unseen:
    """The nominal case with an avoider that sees nothing, one simulation in plain Python: its cost, and the largest
    distance between the two paths at one instant [m]."""
    realisation = nominal.meta.realisation
    # With several realisations, use the one that the nominal trace shows: the worst, which determines the cost.
    evidence, path = _flown(_Blind.of(campaign, installed, None if realisation is None else realisation.seed))
    rows = min(len(path), len(nominal.data))
    apart = np.linalg.norm(path[:rows] - nominal.data[:rows, 1:4], axis=1)
    return evidence.model_copy(update={"deviation": float(apart.max()) if rows else None})


@dataclass(frozen=True)
class _Blind:
    """A closed loop that sees no obstacle; two are equal if their nominal cases are, bit by bit."""

    identity: tuple[str, str, bytes, int | None]
    flights: Flights = field(compare=False)

    @classmethod
    def of(cls, campaign: Campaign, installed: Installed, seed: int | None) -> _Blind:
        blind = unseen(campaign)
        flights = Flights(blind, installed, compiled=False, lanes=1)
        scenario = blind.model_dump_json(include={"scenario", "criterion", "objectives"})
        return cls((flights.loop.digest, scenario, flights.nominal.tobytes(), seed), flights.under(seed))


@lru_cache(maxsize=32)
def _flown(blind: _Blind) -> tuple[Unseen, Floats]:
    """The evidence without a deviation, and the positions (rows, 3) [m].

    Kept for the next run of the same scenario: half a second for each run that a process repeats or varies.
    """
    flight = trace(blind.flights, "unseen", {})
    evidence = Unseen(cost=flight.meta.cost, status=flight.meta.status, reason=flight.meta.reason, deviation=None)
    return evidence, flight.data[:, 1:4].copy()


def unseen(campaign: Campaign) -> Campaign:
    """The campaign with all obstacles hidden from the avoider."""
    scenario = campaign.given_scenario
    return campaign.model_copy(update={"scenario": scenario.model_copy(update={"faults": [*scenario.faults, UNSEEN]})})
