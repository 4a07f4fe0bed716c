"""Detection at the point of closest approach, resolution by vector sharing, in the plane.

    r = p_B - q,  c = v_B - V_A:   tau = -r.c / c.c,   r_m = r + tau c = c^ x (r x c^)
    conflict:  0 < tau < horizon  and  |r_m| < r_safe
    U_A = V_A tau - w (r_safe - |r_m|) r_m / |r_m|,  at the speed |V_A|

V_A is the velocity without a conflict: `speed` towards the goal, less within speed / k_goal of it. r_safe is the
obstacle's radius plus the clearance. w is the fraction of the manoeuvre: 1 against an obstacle that does not give way
(sharing = 0), |v_B| / (|V_A| + |v_B|) between two that both follow the rule (sharing = 1): the slower one moves more.
Of several conflicts the earliest is resolved. A head-on encounter (|r_m| = 0) is resolved to the right.
Source: Park, Oh and Tahk (2008); Srikanthakumar, equations 2.17 to 2.20. Reconstructed: V_A is the velocity towards
the goal, not the current one, with which the manoeuvre would end as soon as it takes effect.
Limits: velocities are assumed constant; a vehicle at rest at its goal does not give way; a new conflict caused by the
manoeuvre is resolved only once it is the earliest.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.closest import NEVER, Rules, resolve
from worker.engine.physics.fields import cruise
from worker.engine.physics.vectors import Goal, Vector, difference, like, norm, right_of, scaled, seen_from, spatial


class ClosestApproach(NamedTuple):
    speed: Annotated[float, Parameter("m/s", "Speed towards the goal", 0.0, 1e3)] = 1.0
    k_goal: Annotated[float, Parameter("1/s", "Speed per distance near the goal", 1e-3, 1e3)] = 1.0
    clearance: Annotated[float, Parameter("m", "Clearance from the obstacle's surface", 0.0, 1e5)] = 1.0
    horizon: Annotated[float, Parameter("s", "Time horizon of conflicts", 1e-2, 1e5)] = 10.0
    sharing: Annotated[float, Parameter("", "Fraction left to the other: 0 nothing, 1 by the rule", 0.0, 1.0)] = 0.0


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Goal, bodies: Any, memory: tuple[()], p: ClosestApproach
) -> tuple[Vector, tuple[()]]:
    way = difference(goal, q)
    own = spatial(scaled(cruise(norm(way), p.speed, p.k_goal), way))
    right = right_of(way)
    soonest, nan_guard, best_x, best_y, best_z = NEVER, 0.0, own[0], own[1], own[2]
    for body in bodies:
        rules = Rules(body.radius + p.clearance, p.horizon, p.sharing)
        r, other = seen_from(q, body)
        tau, u = resolve(r, own, other, right, rules)
        nan_guard += 0.0 * tau
        sooner = tau < soonest
        soonest = tau if sooner else soonest
        best_x = u[0] if sooner else best_x
        best_y = u[1] if sooner else best_y
        best_z = u[2] if sooner else best_z
    return like((best_x + nan_guard, best_y + nan_guard, best_z + nan_guard), q), ()


component = Avoider(
    name="closest_approach",
    title="Point of closest approach, vector sharing",
    dimension=2,
    demand="velocity",
    parameters=ClosestApproach,
    goal=Goal,
    memory=0,
    steer=steer,
)
