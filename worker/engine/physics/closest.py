"""Closest approach of two moving points and its resolution: vectors of three components, in NED or ENU axes.

Park, Oh and Tahk, UAV collision avoidance using simple geometric approach (2008).
"""

from __future__ import annotations

from typing import NamedTuple

from worker.engine.kernels.maths import kernel
from worker.engine.physics.space import Vector, dot3, norm3

NEVER = 1e9
"""The time to a conflict if there is none [s]; NaN if an input is NaN."""
HEAD_ON = 1e-6
"""Below this miss distance its direction is undefined, and the caller's `side` is used [m]."""


class Rules(NamedTuple):
    """Clearance between centres [m], time horizon [s], and how far the resolution is shared with the other, 0 to 1."""

    clearance: float
    horizon: float
    sharing: float


@kernel
def miss(r: Vector, c: Vector) -> tuple[float, Vector]:
    """Time to the closest approach [s] and the displacement there, from relative position r and velocity c."""
    tau = -dot3(r, c) / (dot3(c, c) + 1e-12)
    return tau, (r[0] + tau * c[0], r[1] + tau * c[1], r[2] + tau * c[2])


@kernel
def resolve(r: Vector, own: Vector, other: Vector, side: Vector, rules: Rules) -> tuple[float, Vector]:
    """Time to a conflict, or NEVER, and the velocity that resolves it at the own speed.

    r: position of the other relative to the own [m]; own and other: velocities [m/s]; side: unit vector along which a
    head-on encounter is resolved.
    """
    tau, m = miss(r, (other[0] - own[0], other[1] - own[1], other[2] - own[2]))
    length = norm3(m)
    ahead = length < HEAD_ON
    per_length = 1.0 / (length + 1e-300)
    own_speed = norm3(own)
    other_speed = norm3(other)
    # the faster of the two manoeuvres less (2.20)
    part = other_speed / (own_speed + other_speed + 1e-300)
    moved = (1.0 - rules.sharing + rules.sharing * part) * (rules.clearance - length)
    aim_x = own[0] * tau + moved * (side[0] if ahead else -m[0] * per_length)
    aim_y = own[1] * tau + moved * (side[1] if ahead else -m[1] * per_length)
    aim_z = own[2] * tau + moved * (side[2] if ahead else -m[2] * per_length)
    scale = own_speed / (norm3((aim_x, aim_y, aim_z)) + 1e-12)
    # comparisons lose NaN: the 0 * (...) term propagates it
    never = NEVER + 0.0 * (tau + length + rules.clearance + rules.horizon + rules.sharing)
    conflict = (tau > 0.0) & (tau < rules.horizon) & (length < rules.clearance)
    return (tau if conflict else never), (scale * aim_x, scale * aim_y, scale * aim_z)
