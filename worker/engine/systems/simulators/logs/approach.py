"""The closest approach of a recorded track to obstacles and to another track.

Between two samples a position moves on a straight line, so the minimum is refined within each segment. A track that
does not show where the vehicle was gives no distance: `Unreadable` has the reason.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from worker.engine.systems.base import Floats


class Unreadable(ValueError):
    """The log gives no distance; the message names what is missing and where."""


@dataclass(frozen=True)
class Track:
    """Positions (n, 3) [m] at increasing times (n,) [s], and the name of what was recorded."""

    name: str
    times: Floats
    positions: Floats


@dataclass(frozen=True)
class Sphere:
    """An obstacle with centre and radius [m], in the frame of the log; radius 0 is a point."""

    x: float
    y: float
    z: float
    radius: float = 0.0


@dataclass(frozen=True)
class Column:
    """A vertical obstacle of any height: axis and radius [m], in the frame of the log."""

    x: float
    y: float
    radius: float = 0.0


@dataclass(frozen=True)
class Approach:
    """The smallest distance to a surface [m], when it was [s, clock of the log], and from what; negative inside."""

    d_min: float
    time: float
    to: str


def closest(
    track: Track, obstacles: Sequence[Sphere | Column], other: Track | None, gap: float, lasts: float = 0.0
) -> Approach:
    """The closest approach; raises Unreadable.

    gap: longest time without a sample [s]; beyond it nothing is known about the position. lasts: shortest duration of
    the track [s]; one that ended early may have missed the approach.
    """
    if not gap > 0:
        raise ValueError(f"gap: {gap} s; give the longest time between two samples, above 0")
    if not obstacles and other is None:
        raise ValueError("give obstacles or another track: there is nothing to measure the distance to")
    _check(track, gap)
    duration = track.times[-1] - track.times[0]
    if duration < lasts:
        raise Unreadable(f"{track.name} ends after {duration:.3f} s; at least {lasts:g} s are expected (lasts)")
    found = [_to_obstacle(track, obstacle) for obstacle in obstacles]
    if other is not None:
        _check(other, gap)
        found.append(_to_track(track, other, gap))
    return min(found, key=lambda approach: approach.d_min)


def _check(track: Track, gap: float) -> None:
    if len(track.times) < 2:
        raise Unreadable(f"{track.name} has {len(track.times)} samples; at least 2 are required")
    bad = np.flatnonzero(~np.isfinite(track.times) | ~np.isfinite(track.positions).all(axis=1))
    if bad.size:
        raise Unreadable(f"{track.name} has no finite position at t = {track.times[bad[0]]:.3f} s")
    steps = np.diff(track.times)
    k = int(np.argmin(steps))
    if steps[k] <= 0:
        raise Unreadable(f"the time of {track.name} does not increase after t = {track.times[k]:.3f} s")
    k = int(np.argmax(steps))
    if steps[k] > gap:
        raise Unreadable(
            f"{track.name} has no sample for {steps[k]:.3f} s after t = {track.times[k]:.3f} s; at most {gap:g} s are"
            " allowed (gap)"
        )


def _to_obstacle(track: Track, obstacle: Sphere | Column) -> Approach:
    if isinstance(obstacle, Sphere):
        relative = track.positions - np.array([obstacle.x, obstacle.y, obstacle.z])
    else:
        relative = track.positions[:, :2] - np.array([obstacle.x, obstacle.y])
    if not (np.isfinite(relative).all() and 0.0 <= obstacle.radius < np.inf):
        raise ValueError(f"{obstacle}: finite coordinates and a radius of at least 0 are expected")
    distance, time = _nearest(track.times, relative)
    return Approach(distance - obstacle.radius, time, str(obstacle))


def _to_track(track: Track, other: Track, gap: float) -> Approach:
    first, last = track.times[0], track.times[-1]
    for missing, when in ((other.times[0] - first, first), (last - other.times[-1], other.times[-1])):
        if missing > gap:
            text = f"{other.name} has no sample for {missing:.3f} s after t = {when:.3f} s, while {track.name} has"
            raise Unreadable(f"{text}; at most {gap:g} s are allowed (gap)")
    begin, end = max(first, other.times[0]), min(last, other.times[-1])
    if begin >= end:
        raise Unreadable(f"{track.name} and {other.name} have no time in common")
    times = np.union1d(track.times, other.times)
    times = times[(times >= begin) & (times <= end)]
    distance, time = _nearest(times, _at(track, times) - _at(other, times))
    return Approach(distance, time, other.name)


def _at(track: Track, times: Floats) -> Floats:
    return np.stack([np.interp(times, track.times, axis) for axis in track.positions.T], axis=1)


def _nearest(times: Floats, relative: Floats) -> tuple[float, float]:
    """The smallest distance of the polygon from the origin, and its time."""
    start, step = relative[:-1], np.diff(relative, axis=0)
    length = (step**2).sum(axis=1)
    fraction = np.divide(-(start * step).sum(axis=1), length, out=np.zeros_like(length), where=length > 0)
    fraction = np.clip(fraction, 0.0, 1.0)
    points = start + fraction[:, None] * step
    distances = np.linalg.norm(np.concatenate([points, relative[-1:]]), axis=1)
    k = int(np.argmin(distances))
    if k == len(fraction):
        return float(distances[k]), float(times[-1])
    return float(distances[k]), float(times[k] + fraction[k] * (times[k + 1] - times[k]))
