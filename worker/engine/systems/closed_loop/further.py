"""How far a vehicle gets on its straight line after the last sample, and how near that comes to where obstacles are.

A flight is followed straight on for one horizon. What lies farther ahead is met as well, unless the vehicle stands,
keeps about a place, or slows down to a stop before. One that keeps moving about a place may be anywhere there when an
obstacle comes. Start reading at `remaining`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import samples
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.onward import Path, at_rest
from worker.engine.systems.closed_loop.rounds import Rounds, bend, fitted, rounds
from worker.engine.systems.closed_loop.trace import Seen

STRAIGHT = 0.5
"""A vehicle that got this fraction of its path away at least goes on; of less, it circles, hovers or turns back."""
STANDS = 0.01
"""A vehicle has come to its goal that moved by this fraction of all its path at most in the last half horizon, if it
got away by less than `STRAIGHT` of that or its speed halved there: what creeps there may take any direction, what is
carried away does not."""
INTERVALS = 100
"""Of the last half horizon, for which places are compared."""
GROWS = 2.0
"""What turns may turn on at that rate for so many horizons."""
STEADY = 0.4, 0.05
"""What turned in the last quarter of a horizon by this fraction of its turn in the last half, which is so large [rad],
may turn on for ever, on a circle."""
TOWARDS = 0.5
"""The least cosine of the angle between its velocity and the way to its goal of a vehicle that is under way to it."""
PAST = 2.0
"""A vehicle that slows down passes its goal if it would get so many times as far; one that comes to rest there gets as
far as it is."""
ARC = 1.0
"""Of one that turned steadily by such an angle [rad] it shows whither its circle is carried."""
FOLLOWED = 2000
"""Of a flight, about so many places are looked at if the vehicle keeps about one."""
LATELY = 1, 2, 4
"""Parts of the last half horizon in which a slight turn is looked for: what turned more before may still turn."""
LARGEST = 1e100
"""Coordinates that are as large show nothing [m]."""
MOMENTS = 1000
"""For which a turn is followed."""
SLACK = 1e-9
"""Two distances are taken to be the same that differ by this fraction."""


class Remaining(NamedTuple):
    """lasts: how long the vehicle goes on with the velocity of the last step to get as far as it will [s]; about: how
    far from its last place it may be later, where it keeps moving about that [m]; turned: the largest angle between its
    last velocity and those in the last half horizon [rad], which is half [s]; steady: whether it turned as much in the
    latter half of that; rounds: of one that goes round, if they do not stay where they are; bend: the angular velocity
    (3,) of one that turns evenly by less than is steady [rad/s]."""

    lasts: float = 0.0
    about: float = 0.0
    turned: float = 0.0
    steady: bool = False
    half: float = 0.0
    rounds: Rounds | None = None
    bend: Floats | None = None

    def turns(self, horizon: float) -> float:
        """How long it may turn on [s]: for some horizons, if it turned steadily until it has gone round."""
        around = math.pi * _across(self.turned, self.half) if self.steady else 0.0
        return min(self.lasts, max(GROWS * horizon, around))


def remaining(flights: Flights, row: Floats, trace: Floats, pair: Floats, last: int, halfway: int) -> Remaining:
    """That of a flight until its last step; pair: its last two places; halfway: the step half a horizon before."""
    half = 0.5 * flights.campaign.given_scenario.horizon
    if at_rest(pair, flights):
        return Remaining(half=half)
    every = max(1, (last - halfway) // INTERVALS)
    late, each = (last - halfway) // every, every * flights.step
    places = _seen(flights, row, trace[: last + 1], every).positions
    found = going(places, late, each)._replace(half=half)
    if not np.abs(places).max() < LARGEST:
        return found
    if found.about > 0.0:
        every = max(1, last // FOLLOWED)
        seen = _seen(flights, row, trace[: last + 1], every)
        return found._replace(rounds=rounds(seen.positions, (last - halfway) // every, every * flights.step, seen.goal))
    if found.steady:
        return found._replace(rounds=fitted(places[-1 - late :], each) if found.turned >= ARC else None)
    bends = (bend(places[-1 - late // part :], each) for part in LATELY)
    return found._replace(bend=next((each for each in bends if each is not None), None))


def _seen(flights: Flights, row: Floats, trace: Floats, every: int) -> Seen:
    """The vehicle at its last step, and every so many before."""
    states = np.ascontiguousarray(trace[(len(trace) - 1) % every :: every])
    return Seen(flights, flights.loop.observe(states, row, every * flights.step, 0), row)


def going(places: Floats, late: int, each: float) -> Remaining:
    """That of a vehicle that was at places (n, 3) at equal intervals [s]: it goes nowhere if it stands or keeps about a
    place in the last so many of them, on for ever unless it slows down there."""
    moved = samples.lengths(places[1:] - places[:-1])
    before, moved = moved.sum(), moved[-late:]
    away = samples.lengths(places[-1] - places[-1 - len(moved) :])
    middle, end = len(moved) // 2, len(moved) - 1
    slows = moved[middle:].max(initial=0.0) < 0.5 * moved[:middle].max(initial=0.0)
    keeps = away[0] <= STRAIGHT * moved.sum()
    if moved.sum() <= STANDS * before and (keeps or slows):
        return Remaining()
    if keeps:
        return Remaining(about=float(away.max()))
    turned, later = _turned(places[-1 - len(moved) :]), _turned(places[-1 - middle :])
    steady = turned >= STEADY[1] and later >= STEADY[0] * turned
    if not 0 < middle < end or not moved[0] > moved[middle] > moved[end]:
        return Remaining(math.inf, turned=turned, steady=steady)
    # A speed that falls by the same fraction in every interval; by the smaller one of both halves, which gets farther.
    first, second = (math.log(moved[a] / moved[b]) / (b - a) for a, b in ((0, middle), (middle, end)))
    return Remaining(each / min(first, second), turned=turned, steady=steady)


def _turned(places: Floats) -> float:
    moved = places[1:] - places[:-1]
    lengths = samples.lengths(moved)
    if not len(lengths) or lengths[-1] == 0.0:
        return math.pi
    along = moved[lengths > 0.0] @ moved[-1] / (lengths[lengths > 0.0] * lengths[-1])
    return float(np.arccos(np.clip(along, -1.0, 1.0)).max())


def _across(turned: float, half: float) -> float:
    """In what time a vehicle that turned by an angle in a time would cross the circle on which it goes [s]."""
    return 2.0 * half / turned


def turning(
    relative: Floats, velocity: Floats, turned: float, half: float, times: Floats, steady: bool = False
) -> tuple[float, float]:
    """The smallest distance of places (n, 3) at some times [s] from anywhere that a vehicle may be then, and when;
    half: the time in which it turned by that angle [s], as it may again; steady: it gets no farther than across the
    circle of that turn."""
    speed, there = float(np.linalg.norm(velocity)), samples.lengths(relative)
    farthest = speed * (np.minimum(times, _across(turned, half)) if steady else times)
    along, least = relative @ velocity, there - farthest

    def from_sector(at: Any) -> Floats:
        away, gone = there[at], farthest[at]
        angles = np.arccos(np.clip(along[at] / np.maximum(away * speed, 1e-300), -1.0, 1.0))
        aside = np.clip(angles - turned * (1.0 + times[at] / half), 0.0, 0.5 * np.pi)
        # The nearest place of a sector: on its edge, at its tip or its rim.
        gone = np.clip(away * np.cos(aside), 0.0, gone)
        found: Floats = np.sqrt(np.maximum(away**2 + gone**2 - 2.0 * away * gone * np.cos(aside), 0.0))
        return found

    # No place is nearer than if the vehicle went straight to it: most need no angles.
    nearest = int(np.argmin(least))
    most = float(from_sector([nearest])[0])
    near = np.flatnonzero(~(least > most + SLACK * (there[nearest] + farthest[nearest])))
    found = from_sector(near)
    k = int(np.argmin(found))
    return float(found[k]), float(times[near[k]])


def crossing(relative: Floats, velocity: Floats, lasts: float, drift: Floats) -> tuple[float, float]:
    """The smallest distance of what moves straight on for a while from anywhere on the line that something there goes
    along, and when [s]."""
    # The nearest points of a segment and a ray: both inside, or one at an end.
    u2, w2, uw = float(velocity @ velocity), float(drift @ drift), float(velocity @ drift)
    ur, wr = float(velocity @ relative), float(drift @ relative)
    ends = [0.0, *([lasts] if math.isfinite(lasts) else [])]
    times = [(s, max(0.0, (s * uw - wr) / w2) if w2 else 0.0) for s in ends]
    times.append((min(max(ur / u2, 0.0), lasts) if u2 else 0.0, 0.0))
    determinant = u2 * w2 - uw * uw
    if determinant > 1e-12 * u2 * w2:
        s, t = (ur * w2 - wr * uw) / determinant, (ur * uw - wr * u2) / determinant
        times += [(s, t)] if 0.0 <= s <= lasts and t >= 0.0 else []
    found = [(float(np.linalg.norm(relative + t * drift - s * velocity)), s) for s, t in times]
    return min(found)


def reaching(relative: Floats, drift: Floats, speed: float) -> float:
    """When a vehicle first reaches what is at a place and moves straight on, in whatever direction it goes [s]."""
    square, along, away = float(drift @ drift) - speed**2, float(relative @ drift), float(relative @ relative)
    root = along**2 - square * away
    if along < 0.0:
        return away / (math.sqrt(root) - along) if root >= 0.0 else math.inf
    return (along + math.sqrt(root)) / -square if square < 0.0 else math.inf


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
