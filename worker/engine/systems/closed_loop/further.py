"""How far a vehicle gets on its straight line after the last sample, and how near that comes to where obstacles are.

A flight is followed straight on for one horizon. What lies farther ahead is met as well, unless the vehicle stands,
keeps about a place, or slows down to a stop before. Start reading at `remaining`.
"""

from __future__ import annotations

import math

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.onward import Path, at_rest
from worker.engine.systems.closed_loop.trace import Seen

STRAIGHT = 0.5
"""A vehicle that got this fraction of its path away at least goes on; of less, it circles, hovers or turns back."""
STANDS = 0.01
"""A vehicle has come to its goal that moved by this fraction of all its path at most in the last half horizon: creeping
there, it may take any direction."""
INTERVALS = 100
"""Of the last half horizon, for which places are compared."""


def remaining(flights: Flights, row: Floats, trace: Floats, last: int, halfway: int) -> float:
    """How long the vehicle goes on with the velocity of the last step to get as far as it will [s]; halfway: the step
    half a horizon before."""
    every = max(1, (last - halfway) // INTERVALS)
    each = every * flights.step
    states = np.ascontiguousarray(trace[last % every : last + 1 : every])
    places = Seen(flights, flights.loop.observe(states, row, each, 0), row).positions
    pair = Seen(flights, flights.loop.observe(trace[last - 1 : last + 1], row, flights.step, last - 1), row).positions
    return 0.0 if at_rest(pair, flights) else going(places, (last - halfway) // every, each)


def going(places: Floats, late: int, each: float) -> float:
    """That, of a vehicle that was at places (n, 3) at equal intervals [s]: 0 if it stands or keeps about a place in the
    last so many of them, infinite unless it slows down there."""
    moved = np.linalg.norm(np.diff(places, axis=0), axis=1)
    before, moved = moved.sum(), moved[-late:]
    away = np.linalg.norm(places[-1] - places[-1 - len(moved)])
    if moved.sum() <= STANDS * before or away < STRAIGHT * moved.sum():
        return 0.0
    middle, end = len(moved) // 2, len(moved) - 1
    if not 0 < middle < end or not moved[0] > moved[middle] > moved[end]:
        return math.inf
    # A speed that falls by the same fraction in every interval; by the smaller one of both halves, which gets farther.
    first, second = (math.log(moved[a] / moved[b]) / (b - a) for a, b in ((0, middle), (middle, end)))
    return each / min(first, second)


def passing(relative: Floats, velocity: Floats, lasts: float) -> tuple[Floats, Floats]:
    """The smallest distances to places (n, 3) of what moves straight on for a while, and when [s]."""
    square = float(velocity @ velocity)
    times = np.clip(relative @ velocity / square if square else np.zeros(len(relative)), 0.0, lasts)
    found: Floats = np.linalg.norm(relative - times[:, None] * velocity, axis=1)
    return found, times


def after(path: Path, place: Floats, velocity: Floats, lasts: float) -> tuple[float, float]:
    """The smallest distance to an obstacle's centre after the end of its path, and when [s], of a vehicle that goes
    straight on from a place at that end. Where the path repeats, to any part of it, whenever the obstacle is there."""
    if not path.repeats:
        drift = (path.centres[-1] - path.centres[-2]) / (path.times[-1] - path.times[-2])
        distances, times = passing(path.centres[-1:] - place, velocity - drift, lasts)
        return float(distances[0]), float(times[0])
    between = float(np.linalg.norm(np.diff(path.centres, axis=0), axis=1).max())
    distances, times = passing(path.centres - place, velocity, lasts)
    k = int(np.argmin(distances))
    return float(distances[k]) - between, float(times[k])
