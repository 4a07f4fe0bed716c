"""Checks that the reach of an obstacle covers what its body shows, with every value that its parameters may have, and
that no gap is larger than the distance to its surface."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from campaigns.checked.distances import GAP
from worker.engine.kernels.component import Obstacle, declared
from worker.engine.kernels.reaches import Exceeded, Reaches, States, Values, instants, sampled
from worker.running.examination.mistake import Mistake
from worker.running.examination.scenes import usual

FEW = 5
"""Instants at which other than the nominal values are checked."""
SOME = 40
"""Of the values, so many are checked for the gap."""
STATED = 4
"""A sentence states at most so many values."""


def check_reach(obstacle: Obstacle, states: Sequence[tuple[float, States]], lasts: float, line: int) -> None:
    """Compare the reach with what the body shows from outside; raises `Mistake`.

    states: those of a simulation of the nominal values at some instants, if it has any; lasts: how long it took [s].
    """
    if obstacle.reach is None:
        return
    nominal = {p.name: usual(p, "obstacles.0") for p in declared(obstacle.parameters)}
    limits = {p.name: (p.low, p.high) for p in declared(obstacle.parameters)}
    reaches, begun = Reaches(obstacle), [(0.0, States())]
    # The states at other values are unknown without a simulation of each, except those at the start.
    passing = [(t, States()) for t in instants(lasts)] if obstacle.moving and not obstacle.states else begun
    for values in sampled(nominal, limits):
        first = values is nominal
        if not first and not _ordered(obstacle, values):
            continue
        found = reaches.exceeded(
            values, [*begun, *(states if obstacle.states else passing)] if first else passing[:FEW]
        )
        if found is not None:
            raise Mistake(_sentence(found, nominal), line)


def check_gap(obstacle: Obstacle, line: int) -> None:
    """Compare the gaps at different places with each other; raises `Mistake`."""
    nominal = {p.name: usual(p, "obstacles.0") for p in declared(obstacle.parameters)}
    limits = {p.name: (p.low, p.high) for p in declared(obstacle.parameters)}
    reaches = Reaches(obstacle)
    for values in itertools.islice(sampled(nominal, limits), SOME):
        found = reaches.overstated(values, 0.0) if _ordered(obstacle, values) else None
        if found is not None:
            raise Mistake(
                f"the gap of body is {found.gap:.6g} m{_changed(values, nominal)} at a place where, by the gap nearby, "
                f"the distance to the surface is at most {found.distance:.6g} m: {GAP}",
                line,
            )


def _ordered(obstacle: Obstacle, values: Values) -> bool:
    """Whether a campaign may have these values."""
    return all(
        math.prod(values[name] for name in order.low) <= order.times * math.prod(values[name] for name in order.high)
        for order in obstacle.orders
    )


def _sentence(found: Exceeded, nominal: Values) -> str:
    when = f" at t = {found.time:g} s" if found.time else ""
    return (
        f"reach is {found.reach:g} m{_changed(found.values, nominal)}{when}, and a point of its surface is "
        f"{found.extent:.4g} m from the centre that body reports: give the largest such distance"
    )


def _changed(values: Values, nominal: Values) -> str:
    changed = [f"{name} = {value:g}" for name, value in values.items() if value != nominal[name]]
    more = ["..."] if len(changed) > STATED else []
    return f" with {', '.join([*changed[:STATED], *more]) or 'the nominal values'}"
