"""Detection at the point of closest approach, resolution by vector sharing, in space.

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
Axes as in flight mechanics: z down, so that right is (-y, x) of the course.
"""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.avoiders import closest_approach
from worker.engine.kernels.parameters import in_space
from worker.engine.physics.vectors import SpatialGoal

ClosestApproach = in_space(closest_approach.ClosestApproach, speed=20.0, clearance=50.0, horizon=30.0)

component = replace(
    closest_approach.component,
    name="closest_approach_3d",
    dimension=3,
    parameters=ClosestApproach,
    goal=SpatialGoal,
    frame="ned",
)
