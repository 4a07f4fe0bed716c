"""Compares the distance that a criterion of obstacles declares with what it computes, at places about every obstacle,
and the gaps that surfaces have at different places with each other.

Start reading at `compared`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from campaigns.results.validate import Mismeasured
from worker.engine.kernels.gaps import Gap, centre_of, extent_of, overstated
from worker.engine.kernels.layout import Parts
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.flights import Flights

SAME = 1e-9
"""Values and distances are the same that differ by this fraction of the largest length at most."""
DIRECTIONS = ((0.8, 0.6, 0.0), (-0.28, 0.9, 0.33), (0.1, -0.5, 0.86))
"""Of the lines through an obstacle's centre."""
EXTENTS = (0.9, 3.0, 30.0)
"""Half the lengths of these lines, in extents of the obstacle: inside it, about it, and far away."""
PLACES = 7
"""On each line."""
SHIPPED = "worker.engine.components.obstacles."
"""The home of obstacles whose gaps tests compare."""
VELOCITIES = ((0.0, 0.0, 0.0), (3.0, -2.0, 1.0))
"""Of the vehicle at a place [m/s]: no distance depends on it."""


class Instant(NamedTuple):
    """An instant [s] of a simulation with these parameters, and the loop's state there."""

    row: Floats
    time: float
    state: Floats


def in_flights(flights: Flights) -> Mismeasured | None:
    """The first difference in flights of a campaign: of the nominal case and with the ends of the bounds."""
    steps, every = flights.counts(flights.step)
    nominal, paths, uncertain = flights.nominal, flights.paths, flights.campaign.uncertain
    intervals = {path: of.interval(float(nominal[paths[path]])) for path, of in uncertain.items() if path in paths}
    vectors = [{}, *({path: ends[k] for path, ends in intervals.items()} for k in (0, 1))]
    rows = np.stack([flights.vector(values) for values in vectors])
    # The noise changes no distance between places that are given.
    rows = np.concatenate([flights.realisations.flights(row[None, :])[:1] for row in rows])
    traces = flights.loop.simulate(rows, flights.step, steps, every, traced=len(rows)).trace
    instants = [
        Instant(row, k * flights.step, trace[k, : flights.loop.n_state])
        for row, trace in zip(rows, traces, strict=True)
        for k in (0, steps // 2, steps)
        if np.isfinite(trace[k, : flights.loop.n_state]).all()
    ]
    return compared(flights.loop, flights.parts, instants)


def compared(loop: Loop, parts: Parts, instants: Sequence[Instant]) -> Mismeasured | None:
    """The first difference at some instants; None if there is none, or if the criterion declares no distance."""
    if parts.criterion.of != "obstacles" or parts.criterion.measured_to not in ("centre", "surface"):
        return None
    found = (each for instant in instants for each in _Compared(loop, parts, instant).differences())
    return next(found, None)


class _Compared:
    """The comparison at one instant."""

    def __init__(self, loop: Loop, parts: Parts, instant: Instant) -> None:
        self._loop, self._instant, self._axes = loop, instant, parts.vehicle.dimension
        self._surface, self._count = parts.criterion.measured_to == "surface", len(parts.obstacles)
        self._own = [not each.parameters.__module__.startswith(SHIPPED) for each in parts.obstacles]
        self._inputs, self._p = np.zeros(len(parts.vehicle.inputs)), loop.extend(instant.row)
        at = {f"{s.prefix}.{q.name}": s.first + k for s in loop.sections for k, q in enumerate(s.parameters)}
        body = at.get("criterion.body_radius")
        self._less = 0.0 if body is None or not self._surface else float(instant.row[body])

    def differences(self) -> Iterator[Mismeasured]:
        for obstacle in range(self._count):
            centre = np.array(centre_of(self._bodies(np.zeros(self._axes))[obstacle], self._axes))
            if not np.isfinite(centre).all():
                continue
            gap = partial(self._gap, obstacle)
            yield from self._overstated(obstacle, gap, centre)
            extent = extent_of(gap, centre)
            for direction in DIRECTIONS:
                line = np.array(direction[: self._axes])
                for half in EXTENTS:
                    yield from self._on(obstacle, centre - half * extent * line, half * extent * line)

    def _overstated(self, obstacle: int, gap: Gap, centre: Floats) -> Iterator[Mismeasured]:
        """That the gap of one that is not shipped is larger than the distance to its surface."""
        found = None
        with suppress(ArithmeticError, ValueError):  # it need not be known everywhere
            found = overstated(gap, centre) if self._surface and self._own[obstacle] else None
        if found is not None:
            wrong = self._at(obstacle, found.place, found.distance - self._less, found.gap - self._less)
            yield wrong.model_copy(update={"overstated": True})

    def _on(self, obstacle: int, begin: Floats, half: Floats) -> Iterator[Mismeasured]:
        """The differences at equal intervals of a line; half: the vector to its middle."""
        each = 2.0 / (PLACES - 1)
        values = [self._values(begin, half, velocity) for velocity in VELOCITIES]
        for k in range(PLACES):
            place = begin + k * each * half
            distance = self._distance(place)
            slack = SAME * (1.0 + float(np.abs(place).max()) + abs(distance))
            value = next((v[k] for v in values if not abs(v[k] - distance) <= slack), None)
            if value is not None and math.isfinite(distance):
                yield self._at(obstacle, place, distance, value if math.isfinite(value) else None)

    def _at(self, obstacle: int, place: Floats, distance: float, value: float | None) -> Mismeasured:
        position = [*map(float, place)]
        return Mismeasured(
            obstacle=obstacle, time=self._instant.time, position=position, distance=distance, value=value
        )

    def _values(self, begin: Floats, half: Floats, velocity: Sequence[float]) -> list[float]:
        """The criterion's values on a line."""
        moved = (begin, half, np.array(velocity[: self._axes]))
        start = np.concatenate((self._instant.state, *moved, self._inputs, self._instant.row))
        seen = np.empty((PLACES, self._loop.channels.total))
        channels = self._loop.ahead(start, self._instant.time, 0.0, 0.0, 2.0 / (PLACES - 1), seen)
        return [self._value(row) for row in channels]

    def _value(self, channels: Floats) -> float:
        try:
            return float(self._loop.part("cost")(tuple(map(float, channels)), self._p))
        except ArithmeticError:  # compiled code gives no number there
            return math.nan

    def _distance(self, place: Floats) -> float:
        """That to the nearest obstacle, as declared [m]."""
        bodies = self._bodies(place)
        if self._surface:
            return min(float(body.gap) for body in bodies) - self._less
        return min(math.dist(centre_of(body, self._axes), place) for body in bodies)

    def _bodies(self, place: Floats) -> Any:
        return self._loop.bodies(self._instant.time, self._instant.state, place, self._p)

    def _gap(self, obstacle: int, place: Floats) -> float:
        return float(self._bodies(place)[obstacle].gap)
