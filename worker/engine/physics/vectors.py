"""Vectors of the plane or of space as kernels: one text for tuples of two and of three components.

The length of a tuple is known when a loop is compiled, which drops the other branch: a planar loop computes nothing
along z.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Parameter
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.space import norm3

Vector = Any
"""A tuple of two or three numbers."""


class Goal(NamedTuple):
    """The goal of an avoider in the plane."""

    x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6)]
    y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6)]


class SpatialGoal(NamedTuple):
    """The goal of an avoider in space."""

    x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6)]
    y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6)]
    z: Annotated[float, Parameter("m", "Goal, z", -1e6, 1e6)]


@kernel
def difference(a: Vector, b: Vector) -> Vector:
    """a - b."""
    if len(a) == 2:
        return a[0] - b[0], a[1] - b[1]
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scaled(k: float, v: Vector) -> Vector:
    """k v."""
    if len(v) == 2:
        return k * v[0], k * v[1]
    return k * v[0], k * v[1], k * v[2]


@kernel
def moved(a: Vector, k: float, v: Vector) -> Vector:
    """a + k v."""
    if len(a) == 2:
        return a[0] + k * v[0], a[1] + k * v[1]
    return a[0] + k * v[0], a[1] + k * v[1], a[2] + k * v[2]


@kernel
def norm(v: Vector) -> float:
    """Length of a vector."""
    if len(v) == 2:
        return norm2(v[0], v[1])
    return norm3(v)


@kernel
def spatial(v: Vector) -> tuple[float, float, float]:
    """The vector in space, with z = 0 for one of the plane."""
    if len(v) == 2:
        return v[0], v[1], 0.0
    return v[0], v[1], v[2]


@kernel
def like(v: Vector, other: Vector) -> Vector:
    """A vector in space with as many components as another has."""
    if len(other) == 2:
        return v[0], v[1]
    return v


@kernel
def right_of(way: Vector) -> tuple[float, float, float]:
    """The horizontal unit vector to the right of a displacement; axes in space are north, east, down."""
    flat = 1.0 / (norm2(way[0], way[1]) + 1e-12)
    if len(way) == 2:
        return way[1] * flat, -way[0] * flat, 0.0
    return -way[1] * flat, way[0] * flat, 0.0


@kernel
def halves(state: Vector) -> tuple[Vector, Vector]:
    """Position and velocity of a state that consists of both."""
    if len(state) == 4:
        return (state[0], state[1]), (state[2], state[3])
    return (state[0], state[1], state[2]), (state[3], state[4], state[5])


@kernel
def seen_from(q: Vector, body: Any) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """The position of an obstacle relative to q, and its velocity, both in space."""
    if len(q) == 2:
        return (body.x - q[0], body.y - q[1], 0.0), (body.vx, body.vy, 0.0)
    return (body.x - q[0], body.y - q[1], body.z - q[2]), (body.vx, body.vy, body.vz)


@kernel
def centre(body: Any, q: Vector) -> Vector:
    """The centre of an obstacle, in as many dimensions as q has."""
    if len(q) == 2:
        return body.x, body.y
    return body.x, body.y, body.z


@kernel
def normal(body: Any, q: Vector) -> Vector:
    """The unit vector away from an obstacle, in as many dimensions as q has."""
    if len(q) == 2:
        return body.nx, body.ny
    return body.nx, body.ny, body.nz


@kernel
def round_body(centre: Vector, velocity: Vector, radius: float, q: Vector) -> Body | Body3:
    """A circle or a sphere as seen from q."""
    away = difference(q, centre)
    d = norm(away)
    n = scaled(1.0 / (d + 1e-12), away)
    if len(q) == 2:
        return Body(centre[0], centre[1], velocity[0], velocity[1], radius, d - radius, n[0], n[1])
    x, y, z = centre
    vx, vy, vz = velocity
    return Body3(x, y, z, vx, vy, vz, radius, d - radius, n[0], n[1], n[2])
