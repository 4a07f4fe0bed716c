"""Text of verdicts about a closed loop: components, conditions, settings, terms for evaluations."""

from __future__ import annotations

from campaigns.claims.say import count, listed, number, say
from campaigns.claims.spans import Said
from worker.engine.systems.base import Scope, Words
from worker.engine.systems.closed_loop import distances
from worker.engine.systems.closed_loop.flights import Flights


def words(integrator: str) -> Words:
    """integrator: the name of the reference integrator."""
    return Words(
        one="flight",
        agree=f"the step-halving check and {integrator} agree",
        disagrees=f"the step-halving check or {integrator} disagrees",
        every="all integrations",
        again="simulated again at half the step and with the reference integrator",
        reference="the reference integrator",
    )


def scope(flights: Flights) -> Scope:
    """The scope: components, conditions, horizon and step."""
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


def _measured(flights: Flights) -> Said:
    clause = distances.clause(flights)
    return say("; ", clause) if clause else ()


def _conditions(flights: Flights) -> Said:
    """The clause for the environment, the faults and the noise realisations that the searches simulated."""
    parts, realised = flights.parts, flights.realisations
    titles = [e.title for e in parts.environment] + [f.fault.title for f in parts.faults]
    said = say(", with ", listed(titles)) if titles else ()
    if not realised.random:
        return said
    seeds = listed([str(seed) for seed in realised.seeds])
    if realised.several:
        many = count(len(realised.seeds))
        return say(said, f", {realised.combine} of ", many, " realisations (noise seeds ", seeds, ")")
    return say(said, ", noise seed ", seeds)
