"""What a flight meets after its last sample, one obstacle at a time. Start reading at `End.approaches`.

Known is what a vehicle meets that stops there, or goes straight on for a horizon and then stops. Whatever else it may
do, and whatever an obstacle may do, is unknown where it would come to the threshold: `_open`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import samples
from worker.engine.systems.closed_loop.ahead import SAME, Ahead, Leg
from worker.engine.systems.closed_loop.further import (
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
from worker.engine.systems.closed_loop.onward import Onward, Path, leaves, motion
from worker.engine.systems.closed_loop.rounds import onto
from worker.engine.systems.closed_loop.trace import Seen
from worker.engine.systems.closed_loop.uniform import pivots, uniform

ASIDE = 0.01
"""A wide circle may be aside by this fraction of the way on it."""


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


def _about(value: float, reach: float) -> float:
    """The criterion's value for a place, less how far the vehicle may be from it; less than 0 is no distance."""
    return max(value - reach, min(value, 0.0))


def by_value(approach: Approach) -> float:
    return approach.value


class End:
    """The last sample of a flight, and the obstacle of which the approaches follow. centres: as `motion` takes them;
    below: the lowest value of the evaluations; further: how the vehicle goes on."""

    def __init__(
        self,
        onward: Onward,
        centres: Floats,
        seen: Seen,
        last: int,
        ahead: Ahead,
        below: float,
        further: Callable[[], Remaining],
    ) -> None:
        flights, i = onward.flights, onward.obstacle
        self._onward, self._ahead, self._below, self._further = onward, ahead, below, further
        self._index, self._obstacle, self._threshold = i, flights.parts.obstacles[i], flights.threshold
        self._horizon, self._goal = flights.campaign.given_scenario.horizon, seen.goal
        self._since = last * flights.step - self._horizon
        self._place = seen.positions[1]
        self._own = (seen.positions[1] - seen.positions[0]) / flights.step
        self._relative = seen.centres[1, i] - self._place
        self._drift = (seen.centres[1, i] - seen.centres[0, i]) / flights.step
        self._closing = bool(seen.deciding[1, i] < seen.deciding[0, i])
        self._moves, self._last = motion(onward, centres, self._closing), float(seen.deciding[1, i])

    def approaches(self) -> Iterator[Approach]:
        """Those that are closer than the last sample; and that it is not known what comes, if the obstacle may move on
        in another way than it is taken to."""
        here, found = self._here, [*self._reached()]
        if self._closing and not here.known:
            yield here
        start = here.value if self._bound is None else float(np.linalg.norm(self._relative)) - self._bound
        yield from (each for each in found if each.value < start or not (each.known and here.known))
        if not self._known:
            yield min([here, *found], key=by_value)._replace(known=False, vehicle=False)

    def turning(self) -> Iterator[Approach]:
        """What a vehicle comes to that turned and may turn on, which is not known."""
        further = self._further()
        yield from self._rounds(further)
        yield from self._bending(further)
        lasts = further.turns(self._horizon)
        if lasts == 0.0:
            return
        times, relative = self._ways(lasts)
        path, times = self._path, np.minimum(times, lasts)
        if path and path.repeats and lasts > path.times[-1]:  # it may be anywhere on that by then
            times = np.concatenate([times, np.full(len(times), lasts)])
            relative = np.concatenate([relative, relative])
        distance, when = turning(relative, self._own, further.turned, further.half, times, further.steady)
        yield from self._open(distance - self._extent, when, vehicle=True)

    def _rounds(self, further: Remaining) -> Iterator[Approach]:
        """What is on the way of rounds that are carried on; everything, of those that grow."""
        goes = further.rounds
        if goes is None:
            return
        if goes.grows > 0.0:
            yield from self._open(-self._extent, float(np.linalg.norm(self._relative)) / goes.grows, vehicle=True)
            return
        known = self._path.centres if self._path else (self._place + self._relative)[None]
        straight = self._drift if self._moves.kind == "straight" else np.zeros(3)
        distance, when = goes.nearest(known, straight)
        yield from self._open(max(distance, 0.0) - self._extent, when, vehicle=True)
        lowest = min(self._going(goes.lasts, goes.centre, goes.carried), key=by_value)
        yield from self._open(_about(lowest.value, goes.reach), lowest.time - self._since, vehicle=True)

    def _bending(self, further: Remaining) -> Iterator[Approach]:
        """What is on the wide circle of a vehicle that turns slightly."""
        if further.bend is None:
            return
        once = 2.0 * math.pi / float(np.linalg.norm(further.bend))
        for times, relative, reach in self._courses(once):
            low = samples.nearest(relative - onto(np.zeros(3), self._own, further.bend, times)) - reach
            low -= ASIDE * float(np.linalg.norm(self._own)) * times[:-1]
            k = int(np.argmin(low))
            yield from self._open(float(low[k]) - self._extent, float(times[k]), vehicle=True)

    def _ways(self, lasts: float) -> tuple[Floats, Floats]:
        """Where the obstacle is seen from the vehicle's last place (n, 3) [m], and when: on its path, then straight on
        for so long [s] if that does not repeat."""
        path = self._path
        if path is None:
            times = np.linspace(0.0, lasts, MOMENTS)
            return times, self._relative + np.outer(times, self._drift)
        relative, end = path.centres - self._place, float(path.times[-1])
        if path.repeats or lasts <= end:
            return path.times, relative
        after = np.linspace(0.0, lasts - end, MOMENTS)[1:]
        onward = relative[-1] + np.outer(after, (relative[-1] - relative[-2]) / (end - path.times[-2]))
        return np.concatenate([path.times, end + after]), np.concatenate([relative, onward])

    def _courses(self, lasts: float) -> Iterator[tuple[Floats, Floats, float]]:
        """The same, and how far from there it may be [m]: anywhere on a path that repeats, after its end."""
        times, relative = self._ways(lasts)
        yield times, relative, 0.0
        if self._path and self._path.repeats and lasts > times[-1]:
            low, high = samples.ends(relative)
            middle = 0.5 * (low + high)
            reach = float(samples.lengths(relative - middle).max())
            after = np.linspace(times[-1], lasts, MOMENTS)
            yield after, np.broadcast_to(middle, (MOMENTS, 3)), reach

    def arriving(self) -> Iterator[Approach]:
        """What a vehicle under way to its goal comes to after that is not known, unless it slows down to come to rest
        there: it may turn, and go anywhere. Only what moves straight on may escape."""
        further, own, way = self._further(), self._own, self._goal - self._place
        speed = float(np.linalg.norm(own))
        if further.about > 0.0 or not way @ own > TOWARDS * float(np.linalg.norm(way)) * speed:
            return
        comes = float(way @ own) / speed**2
        if comes * PAST <= further.lasts:
            drift = self._drift if self._moves.kind == "straight" else np.zeros(3)
            when = comes + reaching(self._relative + comes * (drift - own), drift, speed)
            yield from self._open(-self._extent, when, vehicle=True, goal=comes)

    def _open(self, low: float, when: float, vehicle: bool, goal: float | None = None) -> Iterator[Approach]:
        """An approach that is not known, where it would come to the threshold, and below the evaluations."""
        if math.isfinite(when) and low <= self._threshold and low < self._below:
            yield Approach(low, self._index, self._since + when, known=False, vehicle=vehicle, goal=goal)

    @cached_property
    def _here(self) -> Approach:
        """The criterion's value at the last sample; where that is not finite, the distance that it declares, and not
        known: whether anything comes below it cannot be compared."""
        value = self._ahead.value(self._index, self._last)
        known = math.isfinite(value)
        return Approach(value if known else self._ahead.declared(self._index), self._index, self._since, known)

    @cached_property
    def _path(self) -> Path | None:
        """That of an obstacle that is followed."""
        return self._onward.path(self._moves) if self._moves.kind == "followed" else None

    @cached_property
    def _extent(self) -> float:
        """What the criterion subtracts from the distance to the centre [m]; where that is unknown, what the distance at
        the last sample shows of it."""
        known, away = self._ahead.extent(self._index), float(np.linalg.norm(self._relative))
        return max(away - self._ahead.declared(self._index), 0.0) if known is None else known

    @cached_property
    def _bound(self) -> float | None:
        """What is subtracted from distances to the centre of an obstacle that is followed, which have a bound within
        every interval of its path [m]; None if the criterion itself has to be read at its steps."""
        return self._less(self._own)

    def _less(self, own: Floats) -> float | None:
        """The same, of what moves on with another velocity."""
        extent = None if self._path is None else self._ahead.extent(self._index)
        there = self._place + self._horizon * own
        return None if extent is None or self._ahead.leans(self._index, self._place, there) else extent

    @cached_property
    def _known(self) -> bool:
        """Whether the obstacle moves on as it is taken to, for ever."""
        path, moves = self._path, self._moves
        if path is None:
            own = self._obstacle.moving and not self._obstacle.states
            return moves.kind == "straight" and (not own or uniform(self._ahead, self._onward))
        if path.still and not path.whole and moves.lasts and not moves.corners:
            return pivots(self._ahead, self._onward, moves.lasts)
        if path.rests:
            return path.whole and uniform(self._ahead, self._onward, float(path.times[-1]), rests=True)
        return path.whole or leaves(path, self._place)

    def _reached(self) -> Iterator[Approach]:
        """The lowest approaches of a vehicle that stops, and of one that goes on."""
        if self._obstacle.states and not self._closing:
            yield from self._stopping()
            return
        if self._obstacle.moving:
            stops, about = min(self._going(0.0), key=by_value), self._further().about
            yield stops
            if about > 0.0:  # it comes to the place that the vehicle keeps moving about
                yield from self._open(_about(stops.value, about), stops.time - self._since, vehicle=True)
        reached = [*self._going(self._horizon)]
        yield from reached
        lowest = min(reached, key=by_value) if self._path else reached[0]
        if lowest.known and (self._path or self._later(lowest)):
            yield from self._on(lowest)

    def _stopping(self) -> Iterator[Approach]:
        """The approach of an obstacle with states that moves away, if it stops where the vehicle comes on its line."""
        further = self._further()
        distance, when = crossing(self._relative, self._own, max(self._horizon, further.lasts), self._drift)
        if when > 0.0 or distance < float(np.linalg.norm(self._relative)) or further.about > 0.0:
            yield from self._open(distance - further.about - self._extent, when, vehicle=False)

    def _on(self, reached: Approach) -> Iterator[Approach]:
        """What a vehicle comes to that goes straight on for as far as it gets, if that is lower than what it reached
        within a horizon: not known, where it comes to the threshold, or is below the evaluations already."""
        lasts, below = self._further().lasts, self._below
        if lasts <= self._horizon:
            return
        found = min(self._going(lasts), key=by_value)
        meets = found.value <= self._threshold < reached.value
        lower = found.known and self._later(found) and found.value < reached.value
        if lower and (meets or not found.value < below <= reached.value):
            known = found.value >= below or reached.value <= self._threshold
            yield found._replace(known=known, vehicle=not known)

    def _later(self, approach: Approach) -> bool:
        """Whether an approach is later than a vehicle that goes on is followed, or at the end of that."""
        return approach.time - self._since >= self._horizon * (1.0 - SAME)

    def _going(self, lasts: float, place: Floats | None = None, own: Floats | None = None) -> Iterator[Approach]:
        """The lowest approaches of a vehicle that goes straight on for a while [s], and that then stands; of what goes
        from another place, with another velocity, if given."""
        path, less = self._path, self._bound if own is None else self._less(own)
        place, own = self._place if place is None else place, self._own if own is None else own
        end = math.inf if path is None else float(path.times[-1])
        if path is not None and less is not None:
            shown = path.begun(end - self._horizon) if path.repeats and lasts == 0.0 else path
            found = [self._onward.nearest(shown, place, own, lasts, self._below + less + self._further().about)]
            if lasts > end:
                distance, when = after(path, place + end * own, own, lasts - end)
                found.append((distance, end + when))
        else:
            legs = [Leg(0.0, min(lasts, end), place, own)] if lasts > 0.0 else []
            if path is not None and lasts > end:
                # Where it repeats, past all of it and for a turn more.
                there = place + end * own
                passed = float(passing(path.centres - there, own, math.inf)[1].max()) + end
                legs.append(Leg(end, min(passed if path.repeats else math.inf, lasts - end), there, own))
            elif lasts < end and self._obstacle.moving:
                legs.append(Leg(lasts, end - lasts, place + lasts * own, np.zeros(3)))
            drift = self._drift if self._obstacle.states else None
            found = [self._ahead.lowest(self._index, leg, drift) for leg in legs]
            for leg in legs:
                if leg.velocity is own and self._horizon < leg.lasts < math.inf:
                    # The samples of a long line are far apart; those of one without an end reach as far as it falls.
                    soon = self._ahead.lowest(self._index, leg._replace(lasts=math.inf), drift)
                    found += [soon] if soon[1] <= leg.begins + leg.lasts else []
        for value, when in found:
            approach = Approach(value - (less or 0.0), self._index, self._since + when)
            yield approach if math.isfinite(value) else self._here._replace(known=False)
