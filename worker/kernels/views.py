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


@kernel
def moved_by(error: Sight, time: float, vx: float, vy: float, vz: float) -> Sight:
    """A displacement, and more along a velocity for a time."""
    return Sight(
        error.x + time * vx, error.y + time * vy, error.z + time * vz, error.vx, error.vy, error.vz, error.visible
    )


def point2(q: Any) -> tuple[float, float, float]:
    """A plane vector in space."""
    return q[0], q[1], 0.0


def point3(q: Any) -> tuple[float, float, float]:
    """A vector in space as it is."""
    return q  # type: ignore[no-any-return]


def solid2(b: Any) -> Body3:
    """An obstacle in the plane as one in space."""
    return Body3(b.x, b.y, 0.0, b.vx, b.vy, 0.0, b.radius, b.gap, b.nx, b.ny, 0.0)


def solid3(b: Any) -> Body3:
    """An obstacle in space as it is."""
    return b  # type: ignore[no-any-return]


def centre2(b: Any) -> tuple[float, float, float]:
    """The centre of an obstacle in the plane."""
    return b.x, b.y, 0.0


def centre3(b: Any) -> tuple[float, float, float]:
    """The centre of an obstacle in space."""
    return b.x, b.y, b.z


def place2(goal: Any) -> tuple[float, float]:
    """Where a goal in the plane is."""
    return goal.x, goal.y


def place3(goal: Any) -> tuple[float, float, float]:
    """Where a goal in space is."""
    return goal.x, goal.y, goal.z


FAR = 1e7
"""Where an obstacle that is not seen is shown: beyond the reach of any avoider [m]."""


def shifted2(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in the plane looks as it does."""
    return q[0] - error.x, q[1] - error.y


def shifted3(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in space looks as it does."""
    return q[0] - error.x, q[1] - error.y, q[2] - error.z


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
