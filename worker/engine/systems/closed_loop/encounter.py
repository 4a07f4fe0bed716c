"""Evidence that the nominal case is an encounter: closest approach, path length, and the case without avoidance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from campaigns import Campaign
from campaigns.asked.scenario import FaultPart
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Unseen
from campaigns.stored.records import Trace
from worker.engine.kernels.component import Environment, Fault
from worker.engine.kernels.parameters import declared
from worker.engine.kernels.reaches import sampled
from worker.engine.systems.base import Floats, Shown
from worker.engine.systems.closed_loop.distances import in_flights
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.trace import trace

UNSEEN = FaultPart(component="blackout", parameters={"at": 0.0, "duration": 1e6})
"""No obstacle is ever seen: the avoider steers to the goal as if there were none."""
SHIPPED = ("worker.engine.components.environment", "worker.engine.components.faults")
COMPARED = 16, 100
"""Flights that are compared with and without a part that does not change the nominal one; the more only if needed."""


def shown(flights: Flights, nominal: Trace) -> Shown:
    """The evidence for the nominal case with this trace; simulates one more case in plain Python."""
    return Shown(
        ClosestApproach.of(nominal.meta.approach, len(nominal.data)),
        _moved(nominal),
        _unseen(flights.campaign, flights.installed, nominal),
        in_flights(flights),
        late(flights),
        idle(flights),
        late(flights, whole=True),
    )


def late(flights: Flights, whole: bool = False) -> dict[str, tuple[float, float]]:
    """By path, the earliest and the latest instant at which a fault or the environment first changes [s], by the
    switches that it declares, of those for which the latest is after the horizon, or both are at its end: at the ends
    and corners of its own bounds, and some values within. whole: instead, at which that which builds up has its whole
    effect, of those for which the latest is after the horizon."""
    found, uncertain, horizon = {}, flights.campaign.uncertain, flights.campaign.given_scenario.horizon
    for prefix, part in flights.parts.named.items():
        if not isinstance(part, Fault | Environment) or part.switches is None or (whole and not part.whole):
            continue
        at, paths = flights.loop.extended[prefix], {path for path in flights.paths if path.startswith(f"{prefix}.")}
        nominal = {path: float(flights.nominal[flights.paths[path]]) for path in paths}
        bounds = {path: uncertain[path].interval(nominal[path]) for path in paths & uncertain.keys()}
        rows = (flights.loop.extend(flights.vector(values)) for values in sampled(nominal, bounds))
        switches = [[*part.switches(at.fields(*p[at.first : at.last]), horizon)] for p in rows]
        instants = [
            _snapped(sorted(each)[min(part.whole * whole, len(each) - 1)], horizon) for each in switches if each
        ]
        last = max(instants, default=0.0)
        first = min(instants) if len(instants) == len(switches) else 0.0
        if last > horizon or (first == horizon and not whole):
            found[prefix] = (first, last)
    return found


def _snapped(instant: float, horizon: float) -> float:
    """The instant, or the horizon where only rounding sets them apart."""
    return horizon if math.isclose(instant, horizon, rel_tol=1e-9) else instant


def idle(flights: Flights) -> dict[str, int]:
    """By path, the faults and the environment that change no bit of so many flights: of the path of the nominal one, or
    of the criteria of points spread over the bounds. With its default values each has no effect."""
    found = {}
    for prefix, part in flights.parts.named.items():
        if isinstance(part, Fault | Environment):
            neutral = _neutral(flights, prefix, part)
            if neutral is not None and not _changes(flights, neutral):
                found[prefix] = 1 + sum(COMPARED)
    return found


def _neutral(flights: Flights, prefix: str, part: Fault | Environment) -> dict[str, float] | None:
    """The default values of a part by path; None if it has others that are required, or is one of the operator's own
    with its defaults, of which it is only agreed that they have no effect."""
    found: dict[str, float] = {}
    for parameter in declared(part.parameters):
        if parameter.default is None:
            return None
        found[f"{prefix}.{parameter.name}"] = parameter.default
    usual = all(flights.nominal[flights.paths[path]] == value for path, value in found.items())
    if (
        usual
        and not found.keys() & flights.campaign.uncertain.keys()
        and not part.parameters.__module__.startswith(SHIPPED)
    ):
        return None
    return found


def _changes(flights: Flights, neutral: dict[str, float]) -> bool:
    """Whether the default values of a part change a flight."""
    own, chance = flights.nominal[None, :], np.random.default_rng(1)
    if _differ(flights, own, neutral, traced=1):
        return True
    for count in COMPARED:
        rows = np.repeat(own, count, axis=0)
        for path, uncertain in flights.campaign.uncertain.items():
            at = flights.paths[path]
            rows[:, at] = chance.uniform(*uncertain.interval(float(own[0, at])), count)
        if _differ(flights, rows, neutral):
            return True
    return False


def _differ(flights: Flights, rows: Floats, values: dict[str, float], traced: int = 0) -> bool:
    other = rows.copy()
    for path, value in values.items():
        other[:, flights.paths[path]] = value
    one, two = (_simulated(flights, each, traced) for each in (rows, other))
    return not np.array_equal(one, two, equal_nan=True)


def _simulated(flights: Flights, rows: Floats, traced: int) -> Floats:
    """The states of the vehicle in the first flight, or the criteria of all, each under every realisation."""
    realised, (steps, every) = flights.realisations.flights(rows), flights.counts(flights.step)
    made = flights.loop.simulate(realised, flights.step, steps, every, traced=traced)
    states: Floats = made.trace[0][:, : len(flights.parts.vehicle.states)] if traced else made.costs
    return states


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
