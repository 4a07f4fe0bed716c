"""The deciding criterion after the last sample of a flight, while the vehicle goes straight on or has stopped.

The vehicle is moved along its line, and the obstacles' own bodies are asked at every place: a centre need not be fixed,
as that of an upright cylinder is not, and an extent is not the same in all directions. Start reading at `Ahead.lowest`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from worker.engine.kernels.gaps import centre_of
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.trace import Seen, least_within

LEAST, MOST = 64, 20_000
"""So many intervals a line has at least, and at most; in between, a horizon has as many as it has steps."""
PLACES, PIECES = 4, 64
"""Intervals that may hold the minimum, and the parts into which they are divided again and again."""
FINEST = 1e-10
"""Of a line: parts are not divided further."""
SAME = 1e-9
"""Two numbers are the same that differ by this fraction at most."""
DOUBLINGS = 60
"""A line without an end is followed to this power of two horizons at most."""


class Leg(NamedTuple):
    """A line that the vehicle follows. begins: after the last sample [s]; lasts [s], which may be infinite."""

    begins: float
    lasts: float
    place: Floats
    velocity: Floats


class _Line(NamedTuple):
    """A line past obstacles that move by time alone, from a time after the last sample on [s], or past one that is held
    where it is there (None). start: as `Loop.ahead` takes it."""

    begins: float | None
    start: Floats


class Ahead:
    """One flight after its last sample: parameters, state, and what is seen there.

    below: a minimum that cannot be below this is known as exactly as the samples of its line. so_far: the lowest value
    of each channel until then, for criteria that combine obstacles; those of the last sample, if omitted.
    """

    def __init__(
        self,
        flights: Flights,
        row: Floats,
        state: Floats,
        seen: Seen,
        time: float,
        below: float = math.inf,
        so_far: Callable[[], Floats] | None = None,
    ) -> None:
        self._below, self._so_far = below, so_far
        self._flights, self._loop, self._row, self._time = flights, flights.loop, row, time
        self._state, self._axes = state[: flights.loop.n_state], flights.parts.vehicle.dimension
        self._inputs = seen.commands[-1, : len(flights.parts.vehicle.inputs)]
        self._first = flights.loop.channels.of["criterion"][0]
        self._p, self._now = flights.loop.extend(row), seen.channels[-1]
        self._seen, self._place = seen, seen.positions[-1]
        self._sampled: dict[tuple[float | bytes | None, ...], Floats] = {}

    def lowest(self, obstacle: int, leg: Leg, drift: Floats | None = None) -> tuple[float, float]:
        """The criterion's lowest value for one obstacle on a line, and its time after the last sample [s].

        drift: the velocity of an obstacle with states, which it keeps from the last sample on; None for one whose
        motion depends on time alone, which is followed.
        """
        if drift is None:
            line = self._line(leg.begins, leg.place, leg.velocity, leg.velocity)
        else:
            line = self._line(None, leg.place - leg.begins * drift, leg.velocity - drift, leg.velocity)
        lasts = self._until(obstacle, line) if math.isinf(leg.lasts) else leg.lasts
        count = min(max(LEAST, round(lasts / self._flights.step)), MOST) if lasts > 0.0 else 0
        each = lasts / max(count, 1)
        channel = self._coarse(line, each, count)[:, self._first + obstacle]
        low, time = self._finer(obstacle, line, each, channel)
        return self.value(obstacle, low), leg.begins + time

    def value(self, obstacle: int, channel: float) -> float:
        """The criterion's value if one obstacle's channel is that low, and no other is.

        Of a criterion that combines obstacles, which has no finite value where all others are infinitely far away, it
        is that with the lowest channels of the others so far.
        """
        alone, cost = [math.inf] * self._loop.channels.total, self._loop.part("cost")
        alone[self._first + obstacle] = channel
        value = float(cost(tuple(alone), self._p))
        if math.isfinite(value):
            return value
        every = self._others.copy()
        every[self._first + obstacle] = channel
        return float(cost(tuple(map(float, every)), self._p))

    def declared(self, obstacle: int) -> float:
        """The distance to an obstacle that the criterion declares to measure, at the last sample [m]."""
        body = self._body(obstacle, self._place)
        if self._flights.parts.criterion.measured_to == "surface":
            return float(body.gap) - self._seen.parameter("criterion.body_radius")
        return math.dist(centre_of(body, self._axes), self._place[: self._axes])

    @cached_property
    def _others(self) -> Floats:
        now: Floats = self._now
        return now if self._so_far is None else np.minimum(now, self._so_far())

    def extent(self, obstacle: int) -> float | None:
        """What the criterion subtracts from the distance to an obstacle's centre, at most [m]; None if unknown."""
        surface = self._flights.parts.criterion.measured_to == "surface"
        less = self._seen.parameter("criterion.body_radius") if surface else 0.0
        distance = self.declared(obstacle)
        here = self.value(obstacle, float(self._now[self._first + obstacle]))
        if not abs(here - distance) <= SAME * (1.0 + abs(distance)):
            return None  # a criterion of its own
        if not surface:
            return 0.0
        reach = self.reach(obstacle)
        return None if reach is None else reach + less

    def reach(self, obstacle: int) -> float | None:
        """The largest distance of a point inside an obstacle from its centre [m]; None if it is not declared."""
        reach = self._flights.parts.obstacles[obstacle].reach
        if reach is None:
            return None
        return reach.times * math.hypot(*(self._seen.parameter(f"obstacles.{obstacle}.{name}") for name in reach.of))

    def away(self, place: Floats) -> float:
        """How far the vehicle is from a place at the last sample [m]."""
        return float(np.linalg.norm(place - self._place))

    def leans(self, obstacle: int, begin: Floats, end: Floats) -> bool:
        """Whether an obstacle's centre depends on the place from which it is seen on a line."""
        centres = [centre_of(self._body(obstacle, begin + k * (end - begin)), self._axes) for k in (0.0, 0.3, 0.7, 1.0)]
        return any(math.dist(centre, centres[0]) > SAME * (1.0 + math.hypot(*centre)) for centre in centres)

    def carried(self, obstacle: int, leg: Leg, times: tuple[float, float, int]) -> Floats:
        """The criterion's channel of one obstacle from a place that moves along a line; times: the first after it
        begins, the interval [s], and how many."""
        line = self._line(leg.begins, leg.place, leg.velocity, leg.velocity)
        return self._along(line, *times)[:, self._first + obstacle]

    def gap(self, obstacle: int, place: Floats, after: float) -> float:
        """The distance from a place to an obstacle's surface, some time after the last sample [m]."""
        return float(self._body(obstacle, place, after).gap)

    def _body(self, obstacle: int, place: Floats, after: float = 0.0) -> Any:
        """An obstacle some time after the last sample, as seen from a place."""
        return self._loop.bodies(self._time + after, self._state, place[: self._axes], self._p)[obstacle]

    def _line(self, begins: float | None, place: Floats, move: Floats, speed: Floats) -> _Line:
        """move: velocity along the line; speed: that of the vehicle, as criteria see it."""
        vectors = (vector[: self._axes] for vector in (place, move, speed))
        return _Line(begins, np.concatenate((self._state, *vectors, self._inputs, self._row)))

    def _along(self, line: _Line, first: float, each: float, count: int) -> Floats:
        """The channels at a number of instants."""
        return self._shown(line, first, each, np.empty((count, self._loop.channels.total)))

    def _shown(self, line: _Line, first: float, each: float, seen: Floats) -> Floats:
        """The same, in the rows of an array."""
        passes = line.begins is not None
        return self._loop.ahead(line.start, self._time + (line.begins or 0.0), float(passes), first, each, seen)

    def _coarse(self, line: _Line, each: float, count: int) -> Floats:
        """The channels at equal intervals; those of a line that several obstacles share once."""
        key = line.begins, each, count, line.start.tobytes()
        if key not in self._sampled:
            self._sampled[key] = self._along(line, 0.0, each, count + 1)
        return self._sampled[key]

    def _until(self, obstacle: int, line: _Line) -> float:
        """How long a line without an end must be followed: until the channel rises, or no longer falls."""
        lasts = self._flights.campaign.given_scenario.horizon
        for _ in range(DOUBLINGS):
            half, end = self._along(line, 0.5 * lasts, 0.5 * lasts, 2)[:, self._first + obstacle]
            if not end < half:
                break
            lasts *= 2.0
        return lasts

    def _finer(self, obstacle: int, line: _Line, each: float, channel: Floats) -> tuple[float, float]:
        """The minimum of a channel, searched between its samples unless the criterion reads it at the steps alone."""
        k = int(channel.argmin())
        best = float(channel[k]), k * each
        if len(channel) < 2 or self._flights.parts.criterion.over == "steps":
            return best
        least = least_within(channel)
        if self.value(obstacle, float(least.min())) >= self._below:
            return best
        seen = np.empty((PIECES + 1, self._loop.channels.total))
        inside = seen[:, self._first + obstacle]
        for begin in (int(i) * each for i in np.argsort(least, kind="stable")[:PLACES]):
            width = each
            while width > FINEST * each * len(channel):
                part = width / PIECES
                self._shown(line, begin, part, seen)
                at = int(inside.argmin())
                best = min(best, (float(inside[at]), begin + at * part))
                begin, width = begin + min(max(at - 1, 0), PIECES - 2) * part, 2.0 * part
        return best
