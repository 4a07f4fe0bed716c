"""Data that components exchange: obstacles, errors of perception and navigation, effects of the environment.

Obstacles in the plane and in space have the same operations.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from worker.engine.kernels.maths import kernel


class Body(NamedTuple):
    """An obstacle in the plane, relative to the position that it was evaluated for.

    Centre [m], velocity [m/s], radius [m]; distance to the surface [m], negative inside, and the outward unit normal
    there.
    """

    x: float
    y: float
    vx: float
    vy: float
    radius: float
    gap: float
    nx: float
    ny: float


class Body3(NamedTuple):
    """An obstacle in space, as `Body`."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    radius: float
    gap: float
    nx: float
    ny: float
    nz: float


class Sight(NamedTuple):
    """Errors of perception: displacement [m] and velocity error [m/s] of an obstacle; visible is 1 or 0."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    visible: float


class Seen(NamedTuple):
    """Timing of perception: the instant of the observation [s], and the extrapolation time of the tracker [s]."""

    at: float
    ahead: float


class Surroundings(NamedTuple):
    """Effects of the environment: wind in the world frame [m/s], slope of the ground (rise per metre).

    rolling: rolling resistance as a fraction of the weight.
    """

    wind_x: float
    wind_y: float
    wind_z: float
    slope_x: float
    slope_y: float
    rolling: float = 0.0


class Errors(NamedTuple):
    """Errors of navigation: position [m], heading [rad], speed [m/s]."""

    x: float
    y: float
    z: float
    heading: float
    speed: float


CLEAR_SIGHT = Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
NO_ERRORS = Errors(0.0, 0.0, 0.0, 0.0, 0.0)
STILL = Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""The neutral values: no wind and level ground; above, no faults of perception or navigation."""


@kernel
def moved_by(error: Sight, time: float, vx: float, vy: float, vz: float) -> Sight:
    """A sight displaced further, along a velocity for a time."""
    return Sight(
        error.x + time * vx, error.y + time * vy, error.z + time * vz, error.vx, error.vy, error.vz, error.visible
    )


@kernel
def both_sights(a: Sight, b: Sight) -> Sight:
    """The combined effect of two perception faults."""
    return Sight(a.x + b.x, a.y + b.y, a.z + b.z, a.vx + b.vx, a.vy + b.vy, a.vz + b.vz, a.visible * b.visible)


@kernel
def both_errors(a: Errors, b: Errors) -> Errors:
    """The combined effect of two navigation faults."""
    return Errors(a.x + b.x, a.y + b.y, a.z + b.z, a.heading + b.heading, a.speed + b.speed)


@kernel
def both_surroundings(a: Surroundings, b: Surroundings) -> Surroundings:
    """The combined effect of two parts of the environment."""
    return Surroundings(
        a.wind_x + b.wind_x,
        a.wind_y + b.wind_y,
        a.wind_z + b.wind_z,
        a.slope_x + b.slope_x,
        a.slope_y + b.slope_y,
        a.rolling + b.rolling,
    )


@kernel
def solid2(b: Body) -> Body3:
    """An obstacle in the plane as one in space."""
    return Body3(b.x, b.y, 0.0, b.vx, b.vy, 0.0, b.radius, b.gap, b.nx, b.ny, 0.0)


FAR = 1e30
"""Distance at which an unseen obstacle is shown [m]: beyond the range of any avoider, braking distances at the largest
speeds included, and small enough for its powers to be finite."""


@kernel
def shifted(q: Any, error: Sight) -> Any:
    """The position that has the same relative view of the true obstacle as q has of the displaced one."""
    if len(q) == 2:
        return q[0] - error.x, q[1] - error.y
    return q[0] - error.x, q[1] - error.y, q[2] - error.z


@kernel
def shown(b: Any, error: Sight, q: Any) -> Body | Body3:
    """An obstacle as perceived: displaced, or far away if unseen."""
    seen = error.visible > 0.5
    x = b.x + error.x if seen else q[0] + FAR
    y = b.y + error.y if seen else q[1]
    vx = b.vx + error.vx if seen else 0.0
    vy = b.vy + error.vy if seen else 0.0
    gap = b.gap if seen else FAR
    if len(q) == 2:
        return Body(x, y, vx, vy, b.radius, gap, b.nx, b.ny)
    z = b.z + error.z if seen else q[2]
    vz = b.vz + error.vz if seen else 0.0
    return Body3(x, y, z, vx, vy, vz, b.radius, gap, b.nx, b.ny, b.nz)
