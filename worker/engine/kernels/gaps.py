"""Whether the gap of an obstacle's body is above the distance to its surface: no distance changes by more than a place
moves. A gap that does is too large at one of the two places. Start reading at `overstated`.

Sphere tracing finds the places: J. C. Hart, Sphere tracing, The Visual Computer 12 (1996), section 2.1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Gap = Callable[[Floats], float]

DIRECTIONS = 12
"""In the plane, from which the surface is looked for; in space those of a lattice of so many on the sphere."""
AWAY = 30.0
"""From so many extents of the obstacle."""
ALONG = 0.7
"""Fraction of the gap by which a place comes nearer; less than 1, so that most places are outside."""
NEARER = 8
"""How often it does."""
APART = 1e-4, 1e-3, 1e-2, 1e-1
"""Fractions of a gap and an extent by which places are apart that are compared."""
SLACK, INEXACT = 1e-4, 1e-6
"""Fractions of how far they are apart, and of the gap and the extent, by which a gap may change more: it may be found
by iteration, or in single precision."""
ROUNDING = 1e-13
"""And by this fraction of the coordinates."""

POINT = 1e-9
"""An obstacle that extends by less has no extent [m]."""


class Overstated(NamedTuple):
    """Two places outside the obstacle with the gaps there [m]: the first gap is larger than the place is far away."""

    place: Floats
    gap: float
    elsewhere: Floats
    there: float

    @property
    def distance(self) -> float:
        """What the distance at the first place is at most [m]."""
        return self.there + float(np.linalg.norm(self.place - self.elsewhere))


def centre_of(body: Any, axes: int) -> tuple[float, ...]:
    """The centre of an obstacle's body, along so many axes."""
    return tuple(float(getattr(body, axis)) for axis in "xyz"[:axes])


def extent_of(gap: Gap, centre: Floats) -> float:
    """How far an obstacle extends from its centre towards the origin, by its gap there [m]; 1 where that is nothing."""
    extent = abs(float(np.linalg.norm(centre)) - gap(np.zeros(len(centre))))
    return extent if POINT < extent < math.inf else 1.0


def overstated(gap: Gap, centre: Floats) -> Overstated | None:
    """The first gap that is too large at places about an obstacle; None if there is none."""
    extent = extent_of(gap, centre)
    for direction in _directions(len(centre)):
        for place, here in _nearer(gap, centre, direction, extent):
            apart = max(here, 1e-3 * extent)
            steepest = _slope(gap, place, APART[0] * apart)
            length = float(np.linalg.norm(steepest))
            if length <= 1.0 or not math.isfinite(length):
                continue
            pairs = (
                _between(gap, place, each * apart * steepest / length, INEXACT * (here + extent)) for each in APART
            )
            found = [pair for pair in pairs if pair is not None]
            if found:
                return found[-1]
    return None


def _nearer(gap: Gap, centre: Floats, direction: Floats, extent: float) -> Iterator[tuple[Floats, float]]:
    """Places on the line to the centre, outside the obstacle, and their gaps."""
    place = centre + AWAY * extent * direction
    for _ in range(NEARER):
        here = gap(place)
        if not 0.0 < here < math.inf:
            return
        yield place, here
        place = place - ALONG * here * direction


def _slope(gap: Gap, place: Floats, apart: float) -> Floats:
    axes = apart * np.eye(len(place))
    return np.array([(gap(place + axis) - gap(place - axis)) / (2.0 * apart) for axis in axes])


def _between(gap: Gap, place: Floats, half: Floats, inexact: float) -> Overstated | None:
    """Two places on either side, if one gap is too large for the other."""
    far, near = place + half, place - half
    larger, smaller = gap(far), gap(near)
    moved = float(np.linalg.norm(far - near))
    rounding = ROUNDING * (float(np.abs(place).max()) + abs(larger))
    if smaller > 0.0 and larger - smaller > moved * (1.0 + SLACK) + inexact + rounding:
        return Overstated(far, larger, near, smaller)
    return None


def _directions(axes: int) -> list[Floats]:
    """Evenly about, none along an axis."""
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    if axes == 2:
        angles = [2.0 * math.pi * (k + 0.5 * golden) / DIRECTIONS for k in range(DIRECTIONS)]
        return [np.array([math.cos(a), math.sin(a)]) for a in angles]
    heights = [1.0 - (2.0 * k + 1.0) / DIRECTIONS for k in range(DIRECTIONS)]
    turned = [(math.sqrt(1.0 - z * z), 2.0 * math.pi * golden * k, z) for k, z in enumerate(heights)]
    return [np.array([r * math.cos(a), r * math.sin(a), z]) for r, a, z in turned]
