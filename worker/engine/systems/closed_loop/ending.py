"""What a flight meets after its last sample, one obstacle at a time: the vehicle stops there, goes straight on, or
keeps moving about a place or turning. Start reading at `End`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.ahead import SAME, Ahead, Leg
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.further import (
    GROWS,
    MOMENTS,
    PAST,
    TOWARDS,
    Remaining,
    after,
    crossing,
    passing,
    reaching,
    turning,
)
from worker.engine.systems.closed_loop.onward import Motion, Onward, Path, leaves
from worker.engine.systems.closed_loop.trace import Seen
from worker.engine.systems.closed_loop.uniform import pivots, uniform


class Approach(NamedTuple):
    """An approach after the horizon: the criterion's value, the obstacle, and the time after the horizon [s]; of one
    that is simulated the latter two are not known yet. known: False if the obstacle may come closer than that, or if
    it depends on how the vehicle moves on (vehicle), from its goal if it comes there [s] after it was simulated."""

    value: float = math.inf
    obstacle: int | None = None
    time: float = 0.0
    known: bool = True
    vehicle: bool = False
    goal: float | None = None


def by_value(approach: Approach) -> float:
    return approach.value


class End(NamedTuple):
    """The last sample of a flight, and the obstacle of which the approaches follow. below: the lowest value of the
    evaluations; further: how the vehicle goes on."""

    flights: Flights
    seen: Seen
    obstacle: int
    last: int
    ahead: Ahead
    below: float
    further: Callable[[], Remaining]

    @property
    def since(self) -> float:
        """The time after the horizon [s]."""
        return self.last * self.flights.step - self.horizon

    @property
    def horizon(self) -> float:
        return self.flights.campaign.given_scenario.horizon

    @property
    def own(self) -> Floats:
        """The velocity of the vehicle."""
        moved: Floats = (self.seen.positions[1] - self.seen.positions[0]) / self.flights.step
        return moved

    @property
    def extent(self) -> float:
        """What the criterion subtracts from the distance to the centre [m]; where that is unknown, what the distance at
        the last sample shows of it."""
        known = self.ahead.extent(self.obstacle)
        away = float(np.linalg.norm(self.seen.centres[1, self.obstacle] - self.seen.positions[1]))
        return max(away - self.ahead.declared(self.obstacle), 0.0) if known is None else known

    @property
    def here(self) -> Approach:
        """The criterion's value at the last sample; where that is not finite, the distance that it declares, and not
        known: whether anything comes below it cannot be compared."""
        value = self.ahead.value(self.obstacle, float(self.seen.deciding[1, self.obstacle]))
        known = math.isfinite(value)
        return Approach(value if known else self.ahead.declared(self.obstacle), self.obstacle, self.since, known)

    def legs(self, lasts: float) -> tuple[Leg, Leg, Leg]:
        """Those of a vehicle that stops, and of one that goes on for a horizon and then stops; lasts: how long they are
        followed, at least a horizon."""
        place, still = self.seen.positions[1], np.zeros(3)
        there = place + self.horizon * self.own
        going, ends = Leg(0.0, self.horizon, place, self.own), Leg(self.horizon, lasts - self.horizon, there, still)
        return Leg(0.0, lasts, place, still), going, ends

    def straight(self, closing: bool) -> Iterator[Approach]:
        """The approach of an obstacle at rest, of one that moves straight on, and of one with states as if it did."""
        i, obstacle = self.obstacle, self.flights.parts.obstacles[self.obstacle]
        if closing:
            yield self.here
        drift = (self.seen.centres[1, i] - self.seen.centres[0, i]) / self.flights.step if obstacle.states else None
        stops, goes, ends = self.legs(math.inf)
        if obstacle.moving:
            yield from self._closer((stops,), drift)
            yield from self._about(lambda: self.ahead.lowest(i, stops, drift))
        reached = [*self._closer((goes,), drift)]
        yield from (self._judged(each, self._onward(drift)) if self._cut(each) else each for each in reached)
        if obstacle.moving:  # what it has reached is not the lowest where it stops if it would go on
            yield from (each for each in self._closer((ends,), drift) if _lower(each, reached))

    def stopping(self) -> Iterator[Approach]:
        """The approach of an obstacle with states that moves away, if it stops where the vehicle comes on its line."""
        further, (begun, centre) = self.further(), self.seen.centres[:, self.obstacle]
        lasts, relative = max(self.horizon, further.lasts), centre - self.seen.positions[1]
        distance, after = crossing(relative, self.own, lasts, (centre - begun) / self.flights.step)
        if after > 0.0 or distance < float(np.linalg.norm(relative)) or further.about > 0.0:
            yield from self._open(distance - further.about - self.extent, after, vehicle=False)

    def turning(self, onward: Onward, moves: Motion) -> Iterator[Approach]:
        """What a vehicle comes to that turned and may turn on, which is not known."""
        further, i = self.further(), self.obstacle
        half = 0.5 * self.horizon
        turns = max(GROWS * self.horizon, 2.0 * math.pi * half / further.turned if further.steady else 0.0)
        lasts = min(further.lasts, turns)
        if lasts == 0.0:
            return
        if moves.kind == "followed":
            path = onward.path(moves)
            times, centres = path.times, path.centres
        else:
            times, centre = np.linspace(0.0, lasts, MOMENTS), self.seen.centres[1, i]
            centres = centre + np.outer(times, (centre - self.seen.centres[0, i]) / self.flights.step)
        relative = centres - self.seen.positions[1]
        distance, after = turning(relative, self.own, further.turned, half, np.minimum(times, lasts), further.steady)
        yield from self._open(distance - self.extent, after, vehicle=True)

    def arriving(self, moves: Motion) -> Iterator[Approach]:
        """What a vehicle under way to its goal comes to after that is not known, unless it slows down to come to rest
        there: it may turn, and go anywhere. Only what moves straight on may escape."""
        further, own, i = self.further(), self.own, self.obstacle
        speed, way = float(np.linalg.norm(own)), self.seen.goal - self.seen.positions[1]
        if further.about > 0.0 or not way @ own > TOWARDS * float(np.linalg.norm(way)) * speed:
            return
        comes = float(way @ own) / speed**2
        if comes * PAST <= further.lasts:
            straight = moves.kind == "straight"
            drift = (self.seen.centres[1, i] - self.seen.centres[0, i]) / self.flights.step if straight else np.zeros(3)
            relative = self.seen.centres[1, i] - self.seen.positions[1] + comes * (drift - own)
            after = comes + reaching(relative, drift, speed)
            yield from (each._replace(goal=comes) for each in self._open(-self.extent, after, vehicle=True))

    def _open(self, low: float, after: float, vehicle: bool) -> Iterator[Approach]:
        """An approach that is not known, where it would come to the threshold, and below the evaluations."""
        if math.isfinite(after) and low <= self.flights.threshold and low < self.below:
            yield Approach(low, self.obstacle, self.since + after, known=False, vehicle=vehicle)

    def followed(self, onward: Onward, moves: Motion) -> Iterator[Approach]:
        """The approach of an obstacle whose path is known, for as long as it is."""
        path, here = onward.path(moves), self.seen.positions[1]
        extent = self.ahead.extent(self.obstacle)
        if extent is None or self.ahead.leans(self.obstacle, here, here + self.horizon * self.own):
            closer = [*self._exactly(path)]
            found = [self.here, *closer]
        else:
            found = [*self._bounded(onward, path, extent)]
            closer = [each for each in found if each.value < float(np.linalg.norm(path.centres[0] - here)) - extent]
        yield from closer
        known = path.whole or leaves(path, here)
        if path.rests:
            known = uniform(self.ahead, onward, float(path.times[-1]), rests=True) if path.whole else False
        if path.still and not path.whole and moves.lasts and not moves.corners:
            known = pivots(self.ahead, onward, moves.lasts)
        if not known:
            yield min(found, key=by_value)._replace(known=False, vehicle=False)

    def _cut(self, approach: Approach) -> bool:
        """Whether an approach of a vehicle that goes on is later than it is followed, or at the end of that."""
        return approach.known and approach.time - self.since >= self.horizon * (1.0 - SAME)

    def _onward(self, drift: Floats | None) -> Approach:
        """The approach of a vehicle that goes straight on for as far as it gets."""
        lasts = self.further().lasts
        value, after = self.ahead.lowest(self.obstacle, Leg(0.0, math.inf, self.seen.positions[1], self.own), drift)
        if after > lasts:
            value, after = self.ahead.lowest(self.obstacle, Leg(0.0, lasts, self.seen.positions[1], self.own), drift)
        return Approach(value, self.obstacle, self.since + after)

    def _judged(self, reached: Approach, further: Approach) -> Approach:
        """What is stated of a vehicle that is followed to one approach, and has another one if it goes farther: that it
        is not known what comes, where this is lower than the evaluations or comes to the threshold."""
        if not self._cut(further) or not further.value < reached.value:
            return reached
        if reached.value <= self.flights.threshold:
            return further if reached.value < self.below else reached
        meets = further.value <= self.flights.threshold and further.value < self.below
        if meets or reached.value < self.below:
            return further._replace(known=False, vehicle=True)
        return further if further.value >= self.below else reached

    def _about(self, lowest: Callable[[], tuple[float, float]]) -> Iterator[Approach]:
        """What comes is not known where an obstacle comes to the place that the vehicle keeps moving about; lowest: its
        value and its time [s] for a vehicle that stops."""
        about = self.further().about
        if about > 0.0:
            value, after = lowest()
            yield from self._open(max(value - about, min(value, 0.0)), after, vehicle=True)  # a distance

    def _closer(self, legs: Sequence[Leg], drift: Floats | None) -> Iterator[Approach]:
        """The approaches on some lines, as far as they are closer than the last sample."""
        here = self.here
        for leg in legs:
            value, after = self.ahead.lowest(self.obstacle, leg, drift)
            if not math.isfinite(value):
                yield here._replace(known=False)
            elif value < here.value or not here.known:
                yield Approach(value, self.obstacle, self.since + after)

    def _exactly(self, path: Path) -> Iterator[Approach]:
        """The approaches by the criterion itself, at every step of a path that is followed."""
        lasts = float(path.times[-1])
        stops, goes, ends = self.legs(lasts)
        yield from self._closer((stops,), None)
        yield from self._about(lambda: self.ahead.lowest(self.obstacle, stops))
        reached = [*self._closer((goes, ends), None)]
        there, on = self.seen.positions[1] + lasts * self.own, self.further().lasts
        legs = [goes._replace(lasts=min(lasts, on))]
        if on > lasts:
            # Where it repeats, past all of it and for a turn more.
            passed = float(passing(path.centres - there, self.own, math.inf)[1].max()) + lasts
            legs.append(Leg(lasts, min(passed if path.repeats else math.inf, on - lasts), there, self.own))
        further = [*self._closer(legs, None)] if on > self.horizon else []
        lowest = min(reached, key=by_value, default=self.here)
        yield from reached if not further else [self._judged(lowest, min(further, key=by_value))]

    def _bounded(self, onward: Onward, path: Path, extent: float) -> Iterator[Approach]:
        """The approaches by the distances to a centre, which have a bound within every interval of its path."""
        place, lasts, (on, about, *_) = self.seen.positions[1], float(path.times[-1]), self.further()
        below = self.below + extent

        def approach(distance: float, after: float) -> Approach:
            return Approach(distance - extent, self.obstacle, self.since + after)

        stands = path.begun(lasts - self.horizon) if path.repeats else path
        waits = approach(*onward.nearest(stands, place, np.zeros(3), 0.0, below + about))
        yield waits
        yield from self._about(lambda: (waits.value, waits.time - self.since))
        reached = approach(*onward.nearest(path, place, self.own, self.horizon, below))
        if on > self.horizon:
            further = [approach(*onward.nearest(path, place, self.own, on, below))]
            if on > lasts:
                distance, later = after(path, place + lasts * self.own, self.own, on - lasts)
                further.append(approach(distance, lasts + later))
            reached = self._judged(reached, min(further, key=by_value))
        yield reached


def _lower(approach: Approach, others: Sequence[Approach]) -> bool:
    """Whether an approach is lower than others, or not known."""
    return not approach.known or all(approach.value < other.value for other in others)
