"""Checks that the reach of an obstacle covers what its body shows."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle
from worker.running.examination.mistake import Mistake

FAR = 1e3
"""Looked at from this many reaches away, a surface shows its extent in a direction."""
DIRECTIONS = 64
SLACK = 1e-3
"""What is seen from there may differ by this fraction of the reach."""


def check_reach(obstacle: Obstacle, arguments: tuple[object, ...], values: dict[str, float], line: int) -> None:
    """Compare the reach with what the body shows from outside; raises `Mistake`.

    arguments: of a call of the body, (t, o, q, p); values: those of its parameters in that call, by name.
    """
    if obstacle.reach is None:
        return
    t, o, _, p = arguments
    body, axes = plain(obstacle.body), obstacle.dimension
    reach = obstacle.reach.times * math.hypot(*(values[name] for name in obstacle.reach.of))
    middle, away = _centre(body(t, o, (0.0,) * axes, p), axes), FAR * max(1.0, reach)
    for direction in _directions(axes):
        q = tuple(m + away * d for m, d in zip(middle, direction, strict=True))
        there = body(t, o, q, p)
        extent = math.dist(q, _centre(there, axes)) - there.gap
        if extent > reach + SLACK * max(1e-3, reach):
            raise Mistake(
                f"reach is {reach:g} m with the nominal values, and a point of its surface is {extent:.4g} m from the "
                "centre that body reports: give the largest such distance",
                line,
            )


def _centre(body: object, axes: int) -> tuple[float, ...]:
    return tuple(float(getattr(body, axis)) for axis in "xyz"[:axes])


def _directions(axes: int) -> Iterator[tuple[float, ...]]:
    """Directions all around, those of the axes and of the corners between them among them."""
    for k in range(DIRECTIONS if axes == 2 else 0):
        angle = 2.0 * math.pi * k / DIRECTIONS
        yield math.cos(angle), math.sin(angle)
    for way in np.ndindex(*(5,) * axes if axes == 3 else ()):
        length = math.hypot(*(k - 2 for k in way))
        if length:
            yield tuple((k - 2) / length for k in way)
