"""Prescribed paths of moving obstacles: consecutive straight legs at constant speed.

The constants of a path are derived once per simulation, so that a step needs only products and sums.
"""

from __future__ import annotations

import math

from worker.engine.kernels.maths import kernel

Point = tuple[float, float, float]
Leg = tuple[float, float, float, float, float]


@kernel
def leg(start: Point, end: Point, speed: float, begins: float, on: bool) -> Leg:
    """Velocity along a straight leg (3) [m/s], its begin and end [s]; a leg that is not `on` has no duration."""
    dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    length = length if on else 0.0
    rate = speed / (length + 1e-12)
    rate = rate if length > 0.0 else 0.0
    takes = length / (speed + 1e-12)
    return rate * dx, rate * dy, rate * dz, begins, begins + takes


@kernel
def elapsed(t: float, begins: float, ends: float) -> float:
    """Time spent on a leg at t [s]: 0 before it begins, its whole duration after its end."""
    until = t if t < ends else ends
    since = until - begins
    return since if since > 0.0 else 0.0


@kernel
def under_way(t: float, begins: float, ends: float) -> float:
    """1 on the leg, else 0."""
    return 1.0 if (t >= begins) & (t < ends) else 0.0
