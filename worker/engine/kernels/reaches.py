"""Measures how far the body of an obstacle extends from its centre, and compares this with its declared reach.

With some values, at some instants: a reach of parameters that do not move the surface holds at the default values and
no longer at others. Start reading at `Reaches.exceeded`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle, declared
from worker.engine.kernels.gaps import Overstated, centre_of, overstated

Values = Mapping[str, float]
"""The parameters of an obstacle, by name."""
States = tuple[float, ...]

FAR = 1e3
"""Seen from this many reaches away, a surface shows its extent in a direction."""
SLACK = 1e-3
"""What is seen from there may differ by this fraction of the reach."""
ROUNDING = 1000 * np.finfo(float).eps
"""And by this fraction of the coordinates."""
DIRECTIONS = 16
"""In the plane; a point of the surface shows at least 98 % of its distance in one of them."""
FOLLOWED, TURNS = 4, 2
"""From so many of the farthest, the direction is turned so often towards the point that is seen there."""
UNKNOWN = ArithmeticError, ValueError, LookupError, AttributeError
"""What a body raises where it is not known: a simulation that needs it fails. Without the trim from which it derives
constants, it is known only in a run."""
INSTANTS = 17
CORNERS = 64
INNER = 16


class Exceeded(NamedTuple):
    """A point of the surface beyond the reach: with which values, when [s], how far from the centre and what is
    declared [m]."""

    values: Values
    time: float
    extent: float
    reach: float


class Reaches:
    """The declared reach of one obstacle, and its body and start in plain Python.

    trim: that of the vehicle, from which it may derive constants; () if it has none, or if it is unknown.
    """

    def __init__(self, obstacle: Obstacle, trim: object = ()) -> None:
        self._obstacle, self._body, self._trim = obstacle, plain(obstacle.body), trim
        self._derive = None if obstacle.derived is None else plain(obstacle.derived.derive)
        self._wake = None if obstacle.wake is None else plain(obstacle.wake)
        self._directions = _directions(obstacle.dimension)

    def exceeded(self, values: Values, states: Iterable[tuple[float, States]] = ((0.0, ()),)) -> Exceeded | None:
        """The first excess with these values; None if there is none, or where the body cannot be computed with them.

        states: instants with the states there; () for those that it has at the start, or if it has none.
        """
        declared_reach, obstacle = self._obstacle.reach, self._obstacle
        if declared_reach is None:
            return None
        reach = declared_reach.times * math.hypot(*(values[name] for name in declared_reach.of))
        for time, there in states:
            with suppress(*UNKNOWN):
                extent, rounding = self._extent(self._seen(values, time, there), reach)
                if extent > reach + SLACK * max(1e-3, reach) + rounding:
                    own = {q.name: values[q.name] for q in declared(obstacle.parameters)}
                    return Exceeded(own, time, extent, reach)
        return None

    def overstated(self, values: Values, time: float, states: States = ()) -> Overstated | None:
        """The first gap that is larger than the distance to the surface with these values; None as for an excess."""
        with suppress(*UNKNOWN):
            body, axes = self._seen(values, time, states), self._obstacle.dimension
            return overstated(lambda place: float(body(place).gap), np.array(centre_of(body((0.0,) * axes), axes)))
        return None

    def _seen(self, values: Values, time: float, states: States) -> Callable[[Iterable[float]], Any]:
        """The body with these values, as it is seen from a place."""
        own = self._obstacle.parameters(*(float(values[q.name]) for q in declared(self._obstacle.parameters)))
        derived, p = self._obstacle.derived, own
        if derived is not None and self._derive is not None:
            p = derived.constants(*self._derive(own, self._trim))
        there = states or (() if self._wake is None else tuple(map(float, self._wake(p))))
        return lambda place: self._body(time, there, tuple(map(float, place)), p)

    def _extent(self, body: Callable[[Iterable[float]], Any], reach: float) -> tuple[float, float]:
        """How far the surface extends from the centre, and the rounding of this [m]."""
        axes = self._obstacle.dimension
        middle = centre_of(body((0.0,) * axes), axes)
        away = FAR * max(1.0, reach)

        def seen(direction: Sequence[float]) -> tuple[float, tuple[float, ...]]:
            q = tuple(m + away * d for m, d in zip(middle, direction, strict=True))
            shown = body(q)
            centre = centre_of(shown, axes)
            normal = [float(getattr(shown, f"n{axis}")) for axis in "xyz"[:axes]]
            to = tuple(a - shown.gap * n - c for a, n, c in zip(q, normal, centre, strict=True))
            return math.dist(q, centre) - shown.gap, to

        found = sorted((one for one in map(seen, self._directions) if one[0] == one[0]), reverse=True)[:FOLLOWED]
        farthest = max((extent for extent, _ in found), default=-math.inf)
        for _, towards in found:
            for _ in range(TURNS):
                length = math.hypot(*towards)
                if not 0.0 < length < math.inf:
                    break
                extent, towards = seen([t / length for t in towards])
                farthest = max(farthest, extent)
        return farthest, ROUNDING * (away + max(map(abs, middle)))


def instants(lasts: float) -> list[float]:
    """Instants of a time: the start, the middle, the end, and others that no period meets at one phase [s]."""
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    return [part * lasts for part in (0.0, 0.5, 1.0, *(k * golden % 1.0 for k in range(1, INSTANTS - 2)))]


def sampled(nominal: Values, bounds: Mapping[str, tuple[float, float]]) -> Iterator[Values]:
    """The nominal values, the ends of each bound and of every two with the others nominal, corners of all bounds, and
    some values within, the same at every call.

    All corners if there are at most `CORNERS`, else so many.
    """
    yield nominal
    names = [name for name, (low, high) in bounds.items() if low < high]
    if not names:
        return
    for some in (*itertools.combinations(names, 1), *itertools.combinations(names, 2)):
        for ends in itertools.product(*(bounds[name] for name in some)):
            yield {**nominal, **dict(zip(some, ends, strict=True))}
    chance, whole = np.random.default_rng(1), 2 ** len(names) <= CORNERS
    every = itertools.product((0, 1), repeat=len(names))
    for corner in every if whole else chance.integers(0, 2, (CORNERS, len(names))).tolist():
        yield {**nominal, **{name: bounds[name][end] for name, end in zip(names, corner, strict=True)}}
    for point in chance.random((INNER, len(names))).tolist():
        within = {n: bounds[n][0] + part * (bounds[n][1] - bounds[n][0]) for n, part in zip(names, point, strict=True)}
        yield {**nominal, **within}


def _directions(axes: int) -> list[tuple[float, ...]]:
    """Directions all around, those of the axes and of the corners between them among them."""
    if axes == 2:
        angles = (2.0 * math.pi * k / DIRECTIONS for k in range(DIRECTIONS))
        return [(math.cos(angle), math.sin(angle)) for angle in angles]
    grid = (tuple(k - 1 for k in way) for way in np.ndindex(3, 3, 3))
    return [tuple(k / math.hypot(*way) for k in way) for way in grid if any(way)]
