"""Checks that the obstacles of a campaign which are not shipped extend no farther than their declared reach.

Distances to centres hide a vehicle inside an obstacle whose reach is declared too small. A component is examined on its
own, so this looks at the values of the campaign: `check` at the start of a run, `excesses` where nothing is simulated.
"""

from __future__ import annotations

from collections.abc import Container, Iterator

from campaigns import Campaign
from campaigns.asked.problem import Problem as Wrong
from campaigns.checked.check import parameters
from campaigns.limits import CONTINUED
from worker.engine.kernels.component import Obstacle
from worker.engine.kernels.reaches import Exceeded, Reaches, States, Values, instants, sampled
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.closed_loop.flights import Flights
from worker.running.catalogue import installed
from worker.running.runs.repetition import shipped

STATED = 8
"""A sentence states at most so many values."""


def check(campaign: Campaign, problem: Problem) -> None:
    """Raises `CampaignUnusable` if an obstacle extends farther than it declares, at the nominal values or others of the
    bounds; the states of obstacles that have any are simulated."""
    flights = problem.system if isinstance(problem.system, Flights) else None
    if wrong := list(excesses(campaign, flights)):
        raise CampaignUnusable(wrong)


def excesses(campaign: Campaign, flights: Flights | None = None) -> Iterator[Wrong]:
    """The obstacles that extend farther than they declare.

    Without flights, an obstacle with states is checked only with those that it has at the start.
    """
    if campaign.scenario is None:
        return
    components, known = installed.components(), parameters(campaign, installed.catalogue())
    for i, part in enumerate(campaign.scenario.obstacles):
        obstacle = components.get(("obstacle", part.component))
        if not isinstance(obstacle, Obstacle) or obstacle.reach is None or shipped("obstacle", part.component):
            continue
        prefix = f"obstacles.{i}."
        nominal = {path.removeprefix(prefix): v for path, (_, v) in known.items() if path.startswith(prefix)}
        bounds = {name: campaign.interval(f"{prefix}{name}", value) for name, value in nominal.items()}
        found = _first(obstacle, i, sampled(nominal, bounds), campaign.scenario.horizon, flights)
        if found is not None:
            varied = [name for name, (low, high) in bounds.items() if low < high]
            yield Wrong(f"scenario.obstacles.{i}", part.component, sentence(found, {*part.parameters, *varied}))


def _first(
    obstacle: Obstacle, i: int, points: Iterator[Values], horizon: float, flights: Flights | None
) -> Exceeded | None:
    span = None if flights is None else flights.loop.extended.get("trim")
    trim = () if flights is None or span is None else span.fields(*map(float, flights.nominal[span.first : span.last]))
    reaches = Reaches(obstacle, trim)
    for values in points:
        states: list[tuple[float, States]] = [(0.0, ())]
        if obstacle.states and flights is not None:
            states += _simulated(flights, i, values)
        elif obstacle.moving and not obstacle.states:
            states = [(time, ()) for time in instants(CONTINUED * horizon)]
        found = reaches.exceeded(values, states)
        if found is not None:
            return found
    return None


def _simulated(flights: Flights, i: int, values: Values) -> Iterator[tuple[float, States]]:
    """The states of an obstacle at the instants, all other parameters at their nominal values."""
    obstacles, last = flights.parts.obstacles, flights.loop.n_state
    first = last - sum(o.states for o in obstacles[i:])
    row = flights.realisations.flights(flights.vector({f"obstacles.{i}.{n}": v for n, v in values.items()})[None, :])
    steps, every = flights.counts(flights.step)
    trace = flights.loop.simulate(row[:1], flights.step, CONTINUED * steps, every, traced=1).trace[0]
    for time in instants(CONTINUED * flights.campaign.given_scenario.horizon):
        k = min(round(time / flights.step), len(trace) - 1)
        there = tuple(map(float, trace[k, first : first + obstacles[i].states]))
        if all(abs(value) < float("inf") for value in there):
            yield k * flights.step, there


def sentence(found: Exceeded, stated: Container[str]) -> str:
    """What was measured, with which values, and what to do."""
    values = [f"{name} = {value:.6g}" for name, value in found.values.items() if name in stated]
    few = ", ".join([*values[:STATED], *["..."] * (len(values) > STATED)])
    return (
        f"with {few or 'its default values'} its surface extends to {found.extent:.4g} m from its centre at "
        f"t = {found.time:.4g} s, but the reach that its component declares is {found.reach:.4g} m then, so a vehicle "
        "inside it could count as clear: correct `reach` in the component, so that it covers every value that its "
        "parameters may have, or change these values"
    )
