"""The point of closest approach of two movers, and the way around it: vectors of three components, NED or ENU alike.

Park, Oh and Tahk, UAV collision avoidance using simple geometric approach (2008). Start reading at `resolve`.
"""

from __future__ import annotations

from typing import NamedTuple

from worker.kernels.maths import kernel
from worker.physics.space import Vector, dot3, norm3

NEVER = 1e9
"""The time to a conflict where there is none [s]; it is NaN where that cannot be told."""
HEAD_ON = 1e-6
"""A miss distance below which its direction is taken from the caller [m]."""


class Rules(NamedTuple):
    """What is kept and how early: clearance between centres [m], horizon [s], share left to the other, 0 to 1."""

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
    """Time to a conflict, or NEVER, and the velocity that resolves it with one's own speed.

    r: position of the other less one's own [m]; own and other: velocities [m/s]; side: unit vector to which a head-on
    encounter is resolved.
    """
    tau, m = miss(r, (other[0] - own[0], other[1] - own[1], other[2] - own[2]))
    length = norm3(m)
    ahead = length < HEAD_ON
    per_length = 1.0 / (length + 1e-300)
    own_speed = norm3(own)
    other_speed = norm3(other)
    # the faster of the two shares less (2.20)
    part = other_speed / (own_speed + other_speed + 1e-300)
    moved = (1.0 - rules.sharing + rules.sharing * part) * (rules.clearance - length)
    aim_x = own[0] * tau + moved * (side[0] if ahead else -m[0] * per_length)
    aim_y = own[1] * tau + moved * (side[1] if ahead else -m[1] * per_length)
    aim_z = own[2] * tau + moved * (side[2] if ahead else -m[2] * per_length)
    scale = own_speed / (norm3((aim_x, aim_y, aim_z)) + 1e-12)
    # a comparison with NaN is False: 0 times what is compared carries it on
    never = NEVER + 0.0 * (tau + length + rules.clearance + rules.horizon + rules.sharing)
    conflict = (tau > 0.0) & (tau < rules.horizon) & (length < rules.clearance)
    return (tau if conflict else never), (scale * aim_x, scale * aim_y, scale * aim_z)
