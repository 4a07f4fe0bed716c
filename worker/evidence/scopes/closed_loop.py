"""How claims describe a closed loop: components, conditions, settings, terms for evaluations."""

from __future__ import annotations

from campaigns.claims.say import count, listed, number, say
from campaigns.claims.spans import Spans
from campaigns.claims.terms import Condition, Scope, Words
from campaigns.codes import CheckCode
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.evidence.scopes import distances, rates
from worker.evidence.scopes.base import Terms


def terms(system: ClosedLoop) -> Terms:
    """The terms of a closed loop; only criteria on obstacles have a closest approach."""
    near: tuple[Condition, ...] = ("closest approach",) if system.parts.criterion.of == "obstacles" else ()
    reasons = {CheckCode.SAMPLING: rates.unfollowed(system), CheckCode.DISTANCES: distances.overlooked(system)}
    return Terms(
        _scope(system),
        _words(system.reference),
        shows=(*near, "motion", "avoidance"),
        bars=tuple((code, reason) for code, reason in reasons.items() if reason),
    )


def _words(integrator: str) -> Words:
    return Words(
        one="flight",
        agree=f"the step-halving check and {integrator} agree",
        disagrees=f"the step-halving check or {integrator} disagrees",
        every="all integrations",
        again="simulated again at half the step and with the reference integrator",
        reference="the reference integrator",
    )


def _scope(flights: Flights) -> Scope:
    """Components, conditions, horizon and step."""
    parts, scenario = flights.parts, flights.campaign.given_scenario
    obstacles = len(parts.obstacles)
    titles = f"{parts.vehicle.title}, {parts.controller.title}, {parts.avoider.title}"
    return Scope(
        what=say(f"{titles}, {obstacles} {'obstacle' if obstacles == 1 else 'obstacles'}", _conditions(flights)),
        settings=say(
            *("horizon ", number(scenario.horizon, "s"), ", step ", number(scenario.step, "s")), _measured(flights)
        ),
        version=f"components of clearance {flights.installed.catalogue.version}",
    )


def _measured(flights: Flights) -> Spans:
    clause = distances.clause(flights)
    return say("; ", clause) if clause else ()


def _conditions(flights: Flights) -> Spans:
    """The clause for the environment, the faults and the noise realisations that the searches simulated."""
    parts, realised = flights.parts, flights.realisations
    titles = [e.title for e in parts.environment] + [f.fault.title for f in parts.faults]
    statement = say(", with ", listed(titles)) if titles else ()
    if not realised.random:
        return statement
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several:
        many = count(len(realised.seeds))
        return say(statement, f", {realised.combine} of ", many, " realisations (noise seeds ", seeds, ")")
    return say(statement, ", noise seed ", seeds)
