"""Potential field of relative position and velocity in space, for moving obstacles.

    F = k_att (p_tar - h) + sum over obstacles with v_RO > 0 and gap < rho_0 of F_rep1 + F_rep2
    v_RO = (v - v_obs) . n           rho_m = v_RO^2 / (2 A_max)           gap = rho_s - rho_m
    F_rep1 = -eta / gap^2 (1 + v_RO / A_max) n
    F_rep2 = eta v_RO / (rho_s A_max gap^2) (v - v_obs - v_RO n)

h, v: position and velocity of the vehicle; n: unit vector to the nearest point of the obstacle's surface (to the
centre, for a sphere); rho_s: distance from the surface; rho_m: distance needed to brake at A_max; any number of
obstacles of any shape. Farther from the goal than s the attraction is conic: its force stays k_att s (2.7).
Source: Ge and Cui, Dynamic motion planning for mobile robots using potential field method (2002); Srikanthakumar,
equations 3.21 and 3.28 to 3.35, extended to space as in section 3.5. The case called "not defined" there
(rho_s < rho_m) is limited to gap = floor, as is rho_s: a reconstruction, not reached in case 4. The force jumps at
gap = rho_0 and at v_RO = 0.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from worker.engine.components.avoiders import ge_cui, potential_field_3d
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.parameters import in_space
from worker.engine.physics.fields import relative
from worker.engine.physics.space import dot3
from worker.engine.physics.vectors import SpatialGoal as Goal
from worker.engine.physics.vectors import Vector, difference, moved

GeCui = in_space(ge_cui.GeCui, k_att=1.0, eta=1.3e4, rho_0=50.0, A_max=10.0, floor=2.0)


@kernel
def weigh(
    force: Vector, number: float, body: Any, t: float, q: Vector, v: Vector, goal: Goal, m: tuple[()], p: Any
) -> Vector:
    away, outward = difference(v, (body.vx, body.vy, body.vz)), (body.nx, body.ny, body.nz)
    closing = -dot3(away, outward)  # n is the reversed normal
    along, across = relative(body.gap, closing, p.eta, p.rho_0, p.A_max, p.floor)
    inward = across * closing - along
    return moved(moved(force, across, away), inward, outward)


component = replace(
    potential_field_3d.component,
    name="ge_cui_3d",
    title="Potential field for moving obstacles",
    parameters=GeCui,
    weigh=weigh,
)
