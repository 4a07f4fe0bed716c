"""Whether an obstacle that moves by time alone goes on as it is taken to, as far as this can be seen.

What a component declares about its motion may be wrong: one that is declared straight may turn, and one at rest may set
off later. Its own body is evaluated at many later instants, at irregular intervals, because it may repeat a motion.
Start reading at `uniform`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.ahead import Ahead, Leg
from worker.engine.systems.closed_loop.onward import Onward

SPANS, LONGER, COUNT = 5, 4, 32
"""The first span is one horizon, each is so many times as long as the one before, with so many instants."""
IRREGULAR = 0.6180339887
SAME = 1e-6
"""Distances are the same that differ by this fraction at most."""
LEAST = 1.0
"""The smallest distance of the places from the centre [m]."""


def uniform(ahead: Ahead, onward: Onward, after: float = 0.0, rests: bool = False) -> bool:
    """Whether the criterion's distance to the obstacle stays the same, some time after the last sample, from places
    that move at its velocity: then it keeps both its velocity and its shape. rests: whether it has to be at rest."""
    (centre, drift), horizon = onward.drift(after), onward.flights.campaign.given_scenario.horizon
    if rests and np.linalg.norm(drift) * horizon > SAME:
        return False
    farthest = float(np.linalg.norm(centre)) + LONGER**SPANS * horizon * float(np.linalg.norm(drift))
    for place in _places(centre, onward, ahead):
        leg, first = Leg(after, math.inf, place, drift), None
        rounding = 64.0 * np.finfo(float).eps * farthest * (1.0 + math.dist(place, centre))
        for k in range(SPANS):
            each = LONGER**k * horizon / COUNT
            then = ahead.carried(onward.obstacle, leg, (IRREGULAR * each, each * (1.0 + 0.1 * IRREGULAR), COUNT))
            first = then[0] if first is None else first
            if not (np.abs(then - first) <= SAME * abs(first) + rounding).all():
                return False
    return True


def pivots(ahead: Ahead, onward: Onward, turn: float) -> bool:
    """Whether an obstacle whose centre stays where it is turns about it, and is after a turn as it was before [s]."""
    centre, seen = onward.drift(0.0)[0], False
    for place in _places(centre, onward, ahead):
        now = [ahead.gap(onward.obstacle, place, k * IRREGULAR * turn / COUNT) for k in range(COUNT)]
        then = [ahead.gap(onward.obstacle, place, (1.0 + k * IRREGULAR / COUNT) * turn) for k in range(COUNT)]
        slack = SAME * max(LEAST, *map(abs, now))
        if not all(abs(a - b) <= slack for a, b in zip(now, then, strict=True)):
            return False
        seen = seen or max(now) - min(now) > slack
    return seen


def _places(centre: Floats, onward: Onward, ahead: Ahead) -> Iterator[Floats]:
    """The corners of a triangle around a centre, in space of a tetrahedron."""
    reach, space = ahead.reach(onward.obstacle), onward.flights.parts.vehicle.dimension == 3
    away = max(LEAST, 2.0 * reach if reach is not None else ahead.away(centre))
    for k in range(3):
        angle = IRREGULAR + 2.0 * math.pi * k / 3.0
        yield centre + away * np.array([math.cos(angle), math.sin(angle), -0.3 if space else 0.0])
    if space:
        yield centre + away * np.array([0.1, 0.2, 1.0])
