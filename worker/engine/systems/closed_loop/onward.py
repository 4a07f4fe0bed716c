"""Where obstacles move after the last sample of a flight, as far as it is known.

A prescribed motion depends on time alone, so it is followed without simulating anything: for the horizon in which the
vehicle may go on, and then to its last corner, or for a whole turn if it repeats. One with states is known only while
it is at rest or keeps its velocity. Start reading at `motion`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from campaigns.checked.rates import corners, fastest, lasting
from campaigns.limits import ROUNDING
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import samples
from worker.engine.systems.closed_loop.flights import Flights

SAMPLES, FINER = 1000, 64
"""Of all that is followed; an interval that may hold the closest approach is divided again."""
TURN, COARSEST = 100, 16
"""So many intervals a turn that repeats has, and at least if there are more of them than `MOST`."""
MOST = 2**16
"""Intervals; what takes longer is cut, and not known."""
REFINED = 16
"""So many intervals are divided at most."""
PHASES, MANY, EXACTLY = 16, 1000, 1e-9
"""A motion repeats that is in so many parts of a turn where it was, after one and after many, to this fraction."""
FAR = 397.3
"""So many horizons later the mean of a velocity is taken; no round number, because motions may repeat."""
STEADY = 1e-3
"""A velocity has not changed if it differs by this fraction at most."""

Kind = Literal["straight", "followed", "unknown"]


class Motion(NamedTuple):
    """How an obstacle moves on: on a straight line, or standing still; along a path that is followed; or in an
    unknown way. lasts: how long its turn or path takes [s]; corners: those of a path of legs [m]."""

    kind: Kind
    lasts: float = 0.0
    corners: Sequence[tuple[float, ...]] = ()


def motion(onward: Onward, centres: Floats, closing: bool) -> Motion:
    """The motion of an obstacle from the last sample on; centres (5, 3): at the first sample, at two half a horizon
    ago, and at the last two. closing: whether it approaches at the last one."""
    flights, row, i = onward.flights, onward.row, onward.obstacle
    obstacle = flights.parts.obstacles[i]
    entry = flights.installed.catalogue.component("obstacle", obstacle.name)
    if entry is None or not entry.moving:
        return Motion("straight")
    if obstacle.states:
        return Motion("straight" if _known(centres, closing, flights) else "unknown")
    if entry.rate is None:
        return Motion("followed")
    values = {q.name: row[flights.paths[f"obstacles.{i}.{q.name}"]] for q in entry.parameters}
    exactly = {name: (value, value) for name, value in values.items()}
    lasts, path = lasting(entry.rate, exactly), corners(entry.rate, values)
    rests = bool(path) and _same(centres[3], centres[4])
    if fastest(entry.rate, exactly) == 0.0 or (rests and onward.arrived(centres[4], path)):
        return Motion("straight")
    return Motion("followed", 2.0 * lasts if path else lasts, path)  # there and back


def _known(centres: Floats, closing: bool, flights: Flights) -> bool:
    """Whether an obstacle with states has come to rest, or moves away at a constant velocity. One that was never seen
    to move may only be waiting."""
    if at_rest(centres[3:], flights):
        return not _same(centres[0], centres[4])
    return not closing and _steady(centres[1:3], centres[3:])


def _steady(before: Floats, now: Floats) -> bool:
    """Whether the velocity is the same at two pairs of samples."""
    velocity = now[1] - now[0]
    return bool(np.linalg.norm(velocity - (before[1] - before[0])) <= STEADY * np.linalg.norm(velocity))


def at_rest(now: Floats, flights: Flights) -> bool:
    """Whether it would move within another horizon by no more than the rounding of its place at each step, and a
    millionth of the threshold [m]."""
    steps = flights.campaign.given_scenario.horizon / flights.step
    rounding = 4.0 * np.finfo(float).eps * float(np.linalg.norm(now[1]))
    least = ROUNDING * (abs(flights.threshold) or 1.0)
    return bool(np.linalg.norm(now[1] - now[0]) * steps <= least + rounding * steps)


def _moves(centres: Floats) -> bool:
    """Whether places differ."""
    return not all(_same(centres[0], centre) for centre in samples.ends(centres))


def _same(one: Floats, other: Floats) -> bool:
    return bool(np.linalg.norm(other - one) <= 1e-12 * (1.0 + np.linalg.norm(other)))


class Path(NamedTuple):
    """The centre of an obstacle at equal intervals of time, and whether more of it is known: it repeats, or is over and
    rests from then on."""

    times: Floats
    """Since the last sample [s]."""
    centres: Floats
    whole: bool
    rests: bool = False
    """Whether it is at rest at the end."""
    repeats: bool = False
    cut: bool = False
    """Whether it ends before all that was to be followed."""

    @property
    def still(self) -> bool:
        """Whether the centre never moves."""
        return not _moves(self.centres)

    def begun(self, lasts: float) -> Path:
        """Its first part, which is no shorter [s]."""
        count = int(np.searchsorted(self.times, lasts)) + 1
        return self._replace(times=self.times[:count], centres=self.centres[:count])


class Onward:
    """The motion of a flight's obstacle after its last sample, with the vehicle where it was then."""

    def __init__(self, flights: Flights, row: Floats, state: Floats, time: float, i: int) -> None:
        self.flights, self.row, self.obstacle = flights, row, i
        self._state, self._time = state, time
        first = 3 * (i - len(flights.parts.obstacles)) - flights.loop.channels.total
        self._columns = slice(first, first + 3)

    def path(self, moves: Motion) -> Path:
        """Its path for one horizon and then a whole turn: the vehicle goes on for a horizon at most, and meets
        everything within a turn once it stands. One without a turn is followed for another horizon."""
        horizon, turn = self.flights.campaign.given_scenario.horizon, moves.lasts
        length, repeats = horizon + max(horizon, turn), turn > 0.0 and self._returns(turn)
        each = max(min(length / SAMPLES, turn / TURN if turn else math.inf), length / MOST)
        step, first = self._interval(each)
        count = min(math.ceil(length / step), MOST)
        cut = count * step < length or (repeats and step * COARSEST > turn)
        found = self._centres(step, first, count + 2)
        rests = _same(found[-2], found[-1])
        whole = not cut and (repeats or (rests and self._ended(found, moves.corners)))
        return Path(step * np.arange(count + 1, dtype=np.float64), found[:-1], whole, rests, repeats, cut)

    def _returns(self, turn: float) -> bool:
        """Whether it moves, and is after a turn and after many where it was before: a hair's breadth a turn adds up."""
        step = turn / PHASES
        first = math.ceil(self._time / step)
        now, after, later = (self._centres(step, first + k * PHASES, PHASES) for k in (0, 1, MANY))
        slack = EXACTLY * (1.0 + float(np.abs(now).max()))
        return _moves(now) and bool(max(np.abs(after - now).max(), np.abs(later - now).max()) <= slack)

    def _interval(self, least: float) -> tuple[float, int]:
        """An interval that is not shorter [s], and how many there were so far: the loop is observed at multiples of a
        step, so that it divides the time until then, and is no longer than that."""
        first = max(1, math.floor(self._time / least))
        return self._time / first, first

    def _ended(self, path: Floats, ends: Sequence[tuple[float, ...]]) -> bool:
        """Whether rest is the end of a motion: one that was not seen may still begin."""
        return self.arrived(path[-1], ends) if ends else _moves(path) or self._moved()

    def arrived(self, place: Floats, ends: Sequence[tuple[float, ...]]) -> bool:
        """Whether an obstacle that rests at a place has reached the last corner of its path; where it ends at its
        first one, only if it was seen elsewhere before."""
        last = np.array(ends[-1])
        near = ROUNDING * (1.0 + float(np.abs(ends).max(initial=0.0)))
        if not last.size or np.linalg.norm(place[: last.size] - last) > near:
            return False
        return bool(np.linalg.norm(last - ends[0]) > near) or self._moved()

    def _moved(self) -> bool:
        """Whether it was seen to move since the simulation began."""
        return _moves(self._centres(self._time / SAMPLES, 0, SAMPLES + 1))

    def drift(self, after: float) -> tuple[Floats, Floats]:
        """Its centre some time after the last sample, and the mean of its velocity for long after that."""
        begin, far = self._time + after, FAR * self.flights.campaign.given_scenario.horizon
        place = self._centres(begin, 1, 1)[0]
        return place, (self._centres(begin + far, 1, 1)[0] - place) / far

    def _centres(self, step: float, first: int, count: int) -> Floats:
        states = np.broadcast_to(self._state, (count, len(self._state)))
        return np.ascontiguousarray(self.flights.loop.observe(states, self.row, step, first)[:, self._columns])

    def nearest(
        self, path: Path, position: Floats, velocity: Floats, lasts: float, below: float
    ) -> tuple[float, float]:
        """The smallest distance to a vehicle that goes on for a while and then stops, and when [s]; at least that, if
        it is not below a value."""
        low = samples.nearest(samples.relative(path.centres, path.times, position, velocity, lasts))
        values, order = samples.least(low, REFINED + 1)
        best, after = math.inf, 0.0
        for k in (int(k) for k in order[: min(REFINED, len(low))]):
            value, time = float(low[k]), float(path.times[k])
            if value < below:
                value, time = self._finer(path, k, position, velocity, lasts)
            if value < best:
                best, after = value, time
        if len(low) <= REFINED or best <= values[REFINED]:
            return best, after
        return float(values[REFINED]), float(path.times[order[int(np.argmax(values == values[REFINED]))]])

    def _finer(self, path: Path, k: int, position: Floats, velocity: Floats, lasts: float) -> tuple[float, float]:
        coarse = path.times[1]
        step, first = coarse / FINER, (round(self._time / coarse) + k) * FINER
        centres = self._centres(step, first, FINER + 1)
        times = path.times[k] + step * np.arange(FINER + 1)
        low = samples.nearest(samples.relative(centres, times, position, velocity, lasts))
        at = int(np.argmin(low))
        return float(low[at]), float(times[at])


def leaves(path: Path, position: Floats) -> bool:
    """Whether it moves away at the end, at the velocity of half the time before. That says nothing of a path that was
    cut in the middle of a leg."""
    if path.cut:
        return False
    half = len(path.centres) // 2
    before, now = np.linalg.norm(path.centres[-2:] - position, axis=1)
    return bool(now >= before) and _steady(path.centres[half - 1 : half + 1], path.centres[-2:])
