"""Conflict with an intruder and the smallest change of velocity that resolves it; axes with z down.

Goss, Rajvanshi and Subbarao, Aircraft conflict detection and resolution using mixed geometric and collision cone
approaches (2004); Srikanthakumar, equations 7.1, 7.2 and 7.7.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Parameter
from worker.engine.kernels.maths import atan2, kernel, norm2, sincos
from worker.engine.physics.space import Vector, arcsine, dot3, norm3, velocity_vector

NEVER = 1e9
"""The time to the closest approach if there is none ahead [s]."""
TINY = 1e-9


class Plan(NamedTuple):
    """The planned velocity, which is followed while there is no conflict."""

    speed: Annotated[float, Parameter("m/s", "Planned speed", 0.0, 1e3)] = 20.0
    heading: Annotated[float, Parameter("rad", "Planned heading, from north over east", -6.4, 6.4, symbol="ψ")] = 0.0
    climb: Annotated[float, Parameter("rad", "Planned climb angle", -1.5, 1.5, symbol="γ")] = 0.0


class Sensing(NamedTuple):
    """The range of the resolution, and the errors of its sensor readings."""

    radius: Annotated[float, Parameter("m", "Planning radius: the miss distance aimed at", 0.0, 1e5, symbol="R_p")] = (
        92.0
    )
    range: Annotated[float, Parameter("m", "Distance within which intruders are acted on", 0.0, 1e7)] = 600.0
    eta_max: Annotated[float, Parameter("rad", "Largest turn from the line of sight", 0.0, 3.2, symbol="η_max")] = 1.2
    du: Annotated[float, Parameter("m/s", "Error of the own speed reading", -100.0, 100.0, symbol="Δu")] = 0.0
    dpsi: Annotated[float, Parameter("rad", "Error of the own track reading", -3.2, 3.2, symbol="Δψ")] = 0.0
    du0: Annotated[float, Parameter("m/s", "Error of the intruder's speed reading", -100.0, 100.0, symbol="Δu_0")] = 0.0
    dpsi0: Annotated[
        float, Parameter("rad", "Error of the intruder's track reading, anticlockwise", -3.2, 3.2, symbol="Δψ_0")
    ] = 0.0
    instant: Annotated[
        float,
        Parameter("", "Own velocity, rounded: 0 as planned (readings at the nominal case), 1 of the moment", 0.0, 1.0),
    ] = 0.0


class Encounter(NamedTuple):
    """An intruder as perceived.

    n: unit vector to it; right: horizontal unit vector to the right of the line of sight; own, other, relative:
    velocities as read [m/s]; distance [m]; towards: speed of approach as read [m/s];
    across: relative velocity across the line of sight; turn: half angle of the cone of conflict [rad];
    miss: distance of the closest approach [m]; wait: time to it [s]; near: 1 where it comes closer within range.
    """

    n: Vector
    right: Vector
    own: Vector
    other: Vector
    relative: Vector
    distance: float
    towards: float
    across: Vector
    turn: float
    miss: float
    wait: float
    near: float


@kernel
def planned(plan: Plan) -> Vector:
    """The planned velocity."""
    return velocity_vector(plan.speed, plan.heading, plan.climb)


@kernel
def own_reading(v: Vector, plan: Plan, p: Any) -> Vector:
    """The own velocity as measured, with errors."""
    as_planned = velocity_vector(plan.speed + p.du, plan.heading + p.dpsi, plan.climb)
    speed = norm3(v)
    s, c = sincos(p.dpsi)
    longer = 1.0 + p.du / (speed if speed > TINY else 1.0)
    now = (longer * (c * v[0] - s * v[1]), longer * (s * v[0] + c * v[1]), longer * v[2])
    moment = p.instant > 0.5
    return (
        now[0] if moment else as_planned[0],
        now[1] if moment else as_planned[1],
        now[2] if moment else as_planned[2],
    )


@kernel
def perceive(q: Vector, v: Vector, own: Vector, body: Any, p: Any) -> Encounter:
    """One intruder as perceived from q; v is the true own velocity, which determines the measured range rate."""
    x, y, z = body.x - q[0], body.y - q[1], body.z - q[2]
    distance = norm3((x, y, z))
    per = 1.0 / distance
    n = (x * per, y * per, z * per)
    level = norm2(n[0], n[1])
    flat = 1.0 / (level if level > TINY else 1.0)
    right = (-n[1] * flat, n[0] * flat, 0.0)
    speed = norm3((body.vx, body.vy, body.vz))
    longer = 1.0 + p.du0 / (speed if speed > TINY else 1.0)
    s, c = sincos(p.dpsi0)
    other = (longer * (c * body.vx + s * body.vy), longer * (c * body.vy - s * body.vx), longer * body.vz)
    relative = (own[0] - other[0], own[1] - other[1], own[2] - other[2])
    towards = dot3(relative, n)
    across = (relative[0] - towards * n[0], relative[1] - towards * n[1], relative[2] - towards * n[2])
    closing = (v[0] - body.vx) * n[0] + (v[1] - body.vy) * n[1] + (v[2] - body.vz) * n[2]
    turn = arcsine(p.radius * per)
    turn = p.eta_max if turn > p.eta_max else turn
    size = norm3(relative)
    per_size = 1.0 / (size if size > TINY else 1.0)
    wait = distance * towards * per_size * per_size
    near = 1.0 if (closing > 0.0) & (distance < p.range) else 0.0
    miss = distance * norm3(across) * per_size
    return Encounter(n, right, own, other, relative, distance, towards, across, turn, miss, wait, near)


@kernel
def aside(e: Encounter, side: float) -> tuple[Vector, float]:
    """The unit vector towards which the relative velocity is turned, and its present angle in that direction [rad].

    side: 1 right of the line of sight, -1 left, 0 the side that it points to already (the sign of xi in equation 7.7).
    """
    size = norm3(e.across)
    per = 1.0 / (size + 1e-300)
    free = (side == 0.0) & (size > TINY)
    sign = -1.0 if side < 0.0 else 1.0
    h = (
        e.across[0] * per if free else sign * e.right[0],
        e.across[1] * per if free else sign * e.right[1],
        e.across[2] * per if free else 0.0,
    )
    return h, atan2(dot3(e.relative, h), e.towards)


@kernel
def nan_guard(e: Encounter, xi: float, p: Any) -> float:
    """0, but NaN if a reading or limit is NaN: comparisons would treat it as no conflict."""
    return 0.0 * (e.miss + e.wait + e.turn + xi + p.range + p.eta_max + p.radius)  # type: ignore[no-any-return]


@kernel
def resolve(e: Encounter, h: Vector, xi: float) -> Vector:
    """The velocity closest to the own one that passes at the planning radius (7.7, without its 0/0 at xi = 0)."""
    s, c = sincos(e.turn)
    _, projection = sincos(e.turn - xi)
    size = norm3(e.relative) * projection
    return (
        size * (c * e.n[0] + s * h[0]) + e.other[0],
        size * (c * e.n[1] + s * h[1]) + e.other[1],
        size * (c * e.n[2] + s * h[2]) + e.other[2],
    )
