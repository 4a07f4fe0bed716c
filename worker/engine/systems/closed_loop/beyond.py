"""What flights meet beyond the horizon: each is simulated on to a multiple of it, and extrapolated from there.

An obstacle that is still approaching when the horizon ends may come closer than anything that was evaluated. What it
does until twice the horizon is simulated, or until the simulation fails. After that the vehicle stops or goes straight
on (`ahead`); obstacles that move on straight lines go on along them, and those that turn are followed (`onward`). Where
the vehicle would come to the threshold even later, what comes is not known (`further`). Start reading at `met`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache, partial
from typing import NamedTuple, Self

import numpy as np

from campaigns.limits import CONTINUED
from campaigns.results.validate import Beyond, Later
from worker.engine.kernels import loop as closed_loop
from worker.engine.systems.base import Floats, Stopping
from worker.engine.systems.closed_loop.ahead import Ahead
from worker.engine.systems.closed_loop.ending import Approach, End
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.further import remaining
from worker.engine.systems.closed_loop.onward import Onward
from worker.engine.systems.closed_loop.trace import Seen

MEMORY = 2**23
"""The states of the flights that are simulated at a time may take this many bytes."""


class Continued(NamedTuple):
    """A flight after the horizon. last: its last step; 0 of one that failed before the horizon ended. failed: whether
    its simulation fails after that step. near: whether its samples do not exclude that it came below the value until
    then. approaches: the simulated one, and the extrapolated ones. states: at the horizon, and one step before."""

    last: int = 0
    failed: bool = False
    near: bool = False
    approaches: Sequence[Approach] = ()
    states: Floats | None = None

    def reaching(self, cost: float, below: float) -> Self:
        """With the lowest value of its simulation, which is after the horizon if no evaluation has one so low."""
        return self._replace(approaches=[Approach(cost if cost < below else math.inf), *self.approaches])


def met(
    flights: Flights,
    names: Sequence[str],
    vectors: Floats,
    seeds: Sequence[int | None],
    below: float,
    cancelled: Stopping,
) -> Beyond | None:
    """What vectors (m, size) meet, and how many of them come below a value; None for a criterion that is not one of
    obstacles, and when cancelled. seeds: those of vectors with their own noise."""
    if flights.parts.criterion.of != "obstacles":
        return None
    called: list[str] = []
    realised = [np.empty((0, vectors.shape[1]))]
    for name, vector, seed in zip(names, vectors[:, None], seeds, strict=True):
        realisations = flights.realisations
        realised.append(realisations.flights(vector) if seed is None else realisations.flight(vector, seed))
        called += [name] * len(realised[-1])
    rows = np.concatenate(realised)
    found = _continued(flights, rows, below, cancelled)
    if found is None:
        return None
    return Beyond(
        times=CONTINUED,
        flights=len(rows),
        cut_short=sum(each.failed for each in found),
        closer=sum(any(a.known and a.value < below for a in each.approaches) for each in found),
        lowest=_lowest(flights, called, rows, found, known=True),
        unknown=_lowest(flights, called, rows, found, known=False),
    )


def _lowest(
    flights: Flights, names: Sequence[str], rows: Floats, found: Sequence[Continued], known: bool
) -> Later | None:
    every = [(k, a) for k, each in enumerate(found) for a in each.approaches if a.known == known]
    finite = [each for each in every if math.isfinite(each[1].value)]
    if not finite:
        return None
    k, lowest = min(finite, key=lambda each: each[1].value)
    return _later(flights, names[k], rows[k], found[k], lowest)


def _at_a_time(flights: Flights) -> int:
    steps, loop = CONTINUED * flights.counts(flights.step)[0], flights.loop
    return max(1, MEMORY // (8 * (steps + 1) * (loop.n_state + loop.n_held)))


def _continued(flights: Flights, rows: Floats, below: float, cancelled: Stopping) -> list[Continued] | None:
    """Every flight after the horizon; None when cancelled. One that fails there may have come close before: it is
    simulated again to its last step, because the loop gives it no value; all that end at the same one together."""
    found: list[Continued] = []
    some, every = _at_a_time(flights), flights.counts(flights.step)[1]
    for first in range(0, len(rows), some):
        if cancelled():
            return None
        found += _onward(flights, rows[first : first + some], below)
    again: dict[int, list[int]] = {}
    for k, each in enumerate(found):
        if each.near:
            again.setdefault(each.last, []).append(k)
    for last, group in again.items():
        if cancelled():
            return None
        costs = flights.loop.simulate(rows[group], flights.step, last, every).costs[:, 0]
        for k, cost in zip(group, costs, strict=True):
            found[k] = found[k].reaching(float(cost), below)
    return found


def _onward(flights: Flights, rows: Floats, below: float) -> Iterator[Continued]:
    """Each flight, simulated on and extrapolated from its last step; of one that fails, without what it reached."""
    steps, every = flights.counts(flights.step)
    longer = CONTINUED * steps
    result = flights.loop.simulate(rows, flights.step, longer, every, traced=len(rows))
    for k, row in enumerate(rows):
        code, ended = result.status[k], round(result.when[k] / flights.step)
        if code == closed_loop.EXCLUDED or (code != closed_loop.OK and ended <= steps):
            yield Continued()
            continue
        failed, trace = code != closed_loop.OK, result.trace[k]
        last = ended - 1 if failed else longer
        near = failed and not _away(flights, row, trace, last, below)
        approaches = [*_extrapolated(flights, row, trace, last, below)]
        ahead = Continued(last, failed, near, approaches, trace[steps - 1 : steps + 1].copy())
        yield ahead if failed else ahead.reaching(float(result.costs[k, 0]), below)


def _away(flights: Flights, row: Floats, trace: Floats, last: int, below: float) -> bool:
    """Whether the samples after the horizon show that no obstacle came below a value: within a step, a distance to a
    centre falls by no more than the two move against each other."""
    steps = flights.counts(flights.step)[0]
    if not _measures(flights):
        return last == steps
    seen = _seen(flights, row, trace, steps, last)
    between = seen.centres - seen.positions[:, None]
    moved = np.linalg.norm(np.diff(between, axis=0), axis=2).max(axis=0, initial=0.0)
    ahead = Ahead(flights, row, trace[last], seen, last * flights.step)
    extents = [math.inf if (known := ahead.extent(i)) is None else known for i in range(between.shape[1])]
    return bool((np.linalg.norm(between, axis=2).min(axis=0) - moved - extents >= below).all())


def _seen(flights: Flights, row: Floats, trace: Floats, first: int, last: int) -> Seen:
    """Vehicle and obstacles at some steps of a flight."""
    return _shown(flights, row, trace[first : last + 1], first)


def _shown(flights: Flights, row: Floats, states: Floats, first: int) -> Seen:
    """The same, with the states at these steps alone."""
    return Seen(flights, flights.loop.observe(states, row, flights.step, first), row)


def _extrapolated(flights: Flights, row: Floats, trace: Floats, last: int, below: float) -> Iterator[Approach]:
    """The closest approach to every obstacle that comes closer after the last step than it is there, and to every one
    that turns. The vehicle stops at once, or keeps its velocity for another horizon and then stops. If it goes on and
    meets something even later, what comes is not known."""
    if not _measures(flights):
        return
    seen, time = _seen(flights, row, trace, last - 1, last), last * flights.step
    halfway = last - max(1, round(0.5 * flights.counts(flights.step)[0]))
    states = any(obstacle.states for obstacle in flights.parts.obstacles)
    before = _seen(flights, row, trace, halfway - 1, halfway) if states and halfway > 0 else seen
    begun = _seen(flights, row, trace, 0, 0) if states else seen

    def so_far() -> Floats:
        lowest: Floats = _seen(flights, row, trace, 0, last).channels.min(axis=0)
        return lowest

    further = cache(partial(remaining, flights, row, trace, seen.positions, last, max(halfway, 0)))
    ahead = Ahead(flights, row, trace[last], seen, time, below, so_far)
    ends, clear = list[End](), True
    for i in range(len(flights.parts.obstacles)):
        centres = np.concatenate([begun.centres[:1, i], before.centres[:, i], seen.centres[:, i]])
        onward = Onward(flights, row, trace[last], time, i)
        ends.append(End(onward, centres, seen, last, ahead, below, further))
        found = [*ends[-1].approaches()]
        yield from found
        # Else it is known that the threshold is reached, or may be.
        if all(each.value > flights.threshold for each in found):
            yield from ends[-1].turning()
        else:
            clear = False
    if clear:
        for end in ends:
            yield from end.arriving()


def _measures(flights: Flights) -> bool:
    """Whether the criterion is one of distances to obstacles; the first instant of something cannot come later."""
    criterion = flights.parts.criterion
    return criterion.measured_to in ("centre", "surface") and criterion.over != "crossing"


def _later(flights: Flights, name: str, row: Floats, continued: Continued, approach: Approach) -> Later:
    """An approach with the obstacle, its distance and its closing speed at the horizon."""
    (steps, every), last = flights.counts(flights.step), continued.last
    obstacle, time, states = approach.obstacle, approach.time, continued.states
    if obstacle is None or states is None:
        states = flights.loop.simulate(row[None, :], flights.step, last, every, traced=1).trace[0][steps - 1 : last + 1]
    seen = _shown(flights, row, states, steps - 1)
    if obstacle is None:
        after, obstacle = (int(k) for k in np.unravel_index(np.argmin(seen.deciding[1:]), seen.deciding[1:].shape))
        time = after * flights.step
    before, now = map(float, np.linalg.norm(seen.centres[:2, obstacle] - seen.positions[:2], axis=1))
    return Later(
        name=name,
        value=approach.value,
        time=time,
        obstacle=obstacle,
        distance=now,
        closing=(before - now) / flights.step,
        simulated=approach.obstacle is None,
        until=last * flights.step if continued.failed else None,
        vehicle=True if approach.vehicle else None,
        goal=approach.goal,
    )
