"""What components see of each other: obstacles, what perception and navigation make of them, the surroundings.

Obstacles of the plane and of space, and the same operations on both. Start reading at `Body`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from worker.kernels.maths import kernel


class Body(NamedTuple):
    """An obstacle in the plane as an avoider and a criterion see it from where they are.

    Centre [m], velocity [m/s], radius [m]; distance to its surface [m], negative inside, and the unit normal there,
    pointing away from it.
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
    """What perception adds to an obstacle: displacement [m], change of velocity [m/s]; visible is 1, or 0."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    visible: float


class Seen(NamedTuple):
    """When obstacles are seen: the instant [s], and for how long the tracker has carried them on from there [s]."""

    at: float
    ahead: float


class Surroundings(NamedTuple):
    """What the environment does to a vehicle: wind in the world frame [m/s], slope of the ground (rise per metre).

    rolling: resistance of the ground, as a share of the weight.
    """

    wind_x: float
    wind_y: float
    wind_z: float
    slope_x: float
    slope_y: float
    rolling: float = 0.0


class Errors(NamedTuple):
    """What navigation adds to the truth: position [m], heading [rad], speed [m/s]."""

    x: float
    y: float
    z: float
    heading: float
    speed: float


CLEAR_SIGHT = Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
NO_ERRORS = Errors(0.0, 0.0, 0.0, 0.0, 0.0)
STILL = Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""No wind, level ground; without a fault of perception or navigation, the two above."""


@kernel
def moved_by(error: Sight, time: float, vx: float, vy: float, vz: float) -> Sight:
    """A displacement, and more along a velocity for a time."""
    return Sight(
        error.x + time * vx, error.y + time * vy, error.z + time * vz, error.vx, error.vy, error.vz, error.visible
    )


@kernel
def both_sights(a: Sight, b: Sight) -> Sight:
    """What two faults of perception add together."""
    return Sight(a.x + b.x, a.y + b.y, a.z + b.z, a.vx + b.vx, a.vy + b.vy, a.vz + b.vz, a.visible * b.visible)


@kernel
def both_errors(a: Errors, b: Errors) -> Errors:
    """What two faults of navigation add together."""
    return Errors(a.x + b.x, a.y + b.y, a.z + b.z, a.heading + b.heading, a.speed + b.speed)


@kernel
def both_surroundings(a: Surroundings, b: Surroundings) -> Surroundings:
    """What two parts of the environment do together."""
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


FAR = 1e7
"""Where an obstacle that is not seen is shown: beyond the reach of any avoider [m]."""


@kernel
def shifted2(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in the plane looks as it does."""
    return q[0] - error.x, q[1] - error.y


@kernel
def shifted3(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in space looks as it does."""
    return q[0] - error.x, q[1] - error.y, q[2] - error.z


@kernel
def shown2(b: Any, error: Sight, q: Any) -> Body:
    """An obstacle in the plane as perceived: displaced, or far away when it is not seen."""
    seen = error.visible > 0.5
    return Body(
        b.x + error.x if seen else q[0] + FAR,
        b.y + error.y if seen else q[1],
        b.vx + error.vx if seen else 0.0,
        b.vy + error.vy if seen else 0.0,
        b.radius,
        b.gap if seen else FAR,
        b.nx,
        b.ny,
    )


@kernel
def shown3(b: Any, error: Sight, q: Any) -> Body3:
    """An obstacle in space as perceived: displaced, or far away when it is not seen."""
    seen = error.visible > 0.5
    return Body3(
        b.x + error.x if seen else q[0] + FAR,
        b.y + error.y if seen else q[1],
        b.z + error.z if seen else q[2],
        b.vx + error.vx if seen else 0.0,
        b.vy + error.vy if seen else 0.0,
        b.vz + error.vz if seen else 0.0,
        b.radius,
        b.gap if seen else FAR,
        b.nx,
        b.ny,
        b.nz,
    )
