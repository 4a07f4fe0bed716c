"""Checks that the rate of an obstacle covers how its velocity and its shape turn.

The turning of a polygon through points of a path is never more than that of the path, however far apart they are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from campaigns.catalogue import RateEntry
from campaigns.checked.rates import fastest
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle
from worker.engine.kernels.gaps import centre_of
from worker.running.examination.mistake import Mistake

Floats = npt.NDArray[np.float64]
SAMPLES, PLACES = 400, 8
"""Instants in each span, and places around the centre."""
SPANS = 10.0, 1000.0
"""Times over which it is seen to move [s], besides some half turns at the declared rate."""
SOME = 4.0
NEARLY = 0.98
"""Of the time of half a turn: what turns at its two ends does not turn within it."""
SLACK = 1e-3
"""What turns by less does not turn [rad]."""
STILL = 1e-9
"""Of its distance from the origin, within an interval: what moves less is at rest."""

SUCH = {"velocity": 'Rate(("speed",), ("way",))', "shape": 'Rate(("omega",))'}
"""A rate of each that is usual."""


class _Turned(NamedTuple):
    """By how much the velocity or the shape turns [rad], and within what time [s]."""

    what: str
    angle: float
    within: float


def check_rate(obstacle: Obstacle, arguments: tuple[object, ...], values: dict[str, float], line: int) -> None:
    """Compare the rate with how the body moves over time; raises `Mistake`.

    arguments: of a call of the body, (t, o, q, p); values: those of its parameters in that call, by name.
    """
    if obstacle.rate is None or obstacle.states:
        return
    rate = RateEntry.model_validate({name: getattr(obstacle.rate, name) for name in RateEntry.model_fields})
    declared = fastest(rate, {name: (value, value) for name, value in values.items()})
    if not math.isfinite(declared):
        return
    half = math.pi / declared if declared else math.inf
    for span in (*SPANS, *([SOME * half] if declared else [])):
        for found in _turned(obstacle, arguments, span, NEARLY * half):
            if found.angle > (math.pi if declared else 0.0) + SLACK:
                raise Mistake(
                    f"rate is {declared:.4g} rad/s with the nominal values, and its {found.what} turns by "
                    f"{found.angle:.4g} rad within {found.within:.4g} s: declare a rate of at least "
                    f"{found.angle / found.within:.4g} rad/s with these values, such as {SUCH[found.what]}, or no rate",
                    line,
                )


def _turned(obstacle: Obstacle, arguments: tuple[object, ...], span: float, within: float) -> list[_Turned]:
    """The most that velocity and shape turn within a time, while a span passes."""
    centres, gaps, away = _motion(obstacle, arguments, np.linspace(0.0, span, SAMPLES + 1))
    each, found = span / SAMPLES, []
    # Two intervals meet at a corner, so one fewer fits into the time.
    for what, steps, less in (("velocity", corners(centres), 1), ("shape", _changes(gaps) / away, 0)):
        count = int(min(within / each, SAMPLES)) - less
        if count > 0 and len(steps):
            total = np.concatenate([np.zeros(1), np.cumsum(steps)])
            count = min(count, len(steps))
            angle = float((total[count:] - total[:-count]).max())
            found.append(_Turned(what, angle, (count + less) * each))
    return found


def _motion(obstacle: Obstacle, arguments: tuple[object, ...], times: Floats) -> tuple[Floats, Floats, float]:
    """The centre (m, axes) and the distances (m, places) of the surface from places that go with it; how far these are
    from the centre [m]. None of them, if the centre depends on the place from which it is seen."""
    _, o, q, p = arguments
    body, axes = plain(obstacle.body), obstacle.dimension
    start = np.array(centre_of(body(0.0, o, q, p), axes))
    away = max(1.0, float(body(0.0, o, q, p).radius))
    around = [away * direction for direction in _directions(axes)]
    if any(centre_of(body(0.0, o, tuple(start + d), p), axes) != tuple(start) for d in around):
        return np.empty((0, axes)), np.empty((0, PLACES)), away
    centres = np.array([centre_of(body(float(t), o, q, p), axes) for t in times])
    gaps = [
        [body(float(t), o, tuple(map(float, c + d)), p).gap for d in around]
        for t, c in zip(times, centres, strict=True)
    ]
    return centres, np.array(gaps), away


def _directions(axes: int) -> list[Floats]:
    """Directions around, in space at several heights."""
    angles = [0.3 + 2.0 * math.pi * k / PLACES for k in range(PLACES)]
    height = [0.8 * math.cos(3.0 * angle) for angle in angles] if axes == 3 else [0.0] * PLACES
    level = [math.sqrt(1.0 - z * z) for z in height]
    rows = zip(level, angles, height, strict=True)
    return [np.array([r * math.cos(a), r * math.sin(a), z])[:axes] for r, a, z in rows]


def corners(centres: Floats) -> Floats:
    """The angle between the intervals before and after every inner sample; rest does not end the one before."""
    moved = np.diff(centres, axis=0)
    length = np.linalg.norm(moved, axis=1)
    moving = length > STILL * (1.0 + np.linalg.norm(centres[1:], axis=1))
    angles, last = np.zeros(max(len(moved) - 1, 0)), None
    for k in np.flatnonzero(moving):
        way = moved[k] / length[k]
        if last is not None:
            angles[k - 1] = 2.0 * math.atan2(float(np.linalg.norm(way - last)), float(np.linalg.norm(way + last)))
        last = way
    return angles


def _changes(gaps: Floats) -> Floats:
    """The largest change of a distance from any place within every interval: turning moves no point faster than its
    distance from the centre times the rate."""
    if not len(gaps):
        return np.empty(0)
    largest: Floats = np.abs(np.diff(gaps, axis=0)).max(axis=1)
    return largest
