"""Potential field of relative position and velocity in the plane, for moving obstacles.

    F = k_att (p_tar - h) + sum over obstacles with v_RO > 0 and gap < rho_0 of F_rep1 + F_rep2
    v_RO = (v - v_obs) . n           rho_m = v_RO^2 / (2 A_max)           gap = rho_s - rho_m
    F_rep1 = -eta / gap^2 (1 + v_RO / A_max) n
    F_rep2 = eta v_RO / (rho_s A_max gap^2) (v - v_obs - v_RO n)

h, v: position and velocity of the robot; n: unit vector to the nearest point of the obstacle's surface (to the
centre, for a circle); rho_s: distance from the surface; rho_m: distance needed to brake at A_max; any number of
obstacles of any shape. Farther from the goal than s the attraction is conic: its force stays k_att s (2.7).
Source: Ge and Cui, Dynamic motion planning for mobile robots using potential field method (2002); Srikanthakumar,
equations 3.21, 3.28 to 3.36. The case called "not defined" there (rho_s < rho_m) is limited to gap = floor, as is
rho_s: a reconstruction, not reached in case 2. The potential vanishes at gap = rho_0, but its gradient, the force,
does not, and it also jumps at v_RO = 0: where a trajectory crosses these edges, the integration error is only of first
order in the step, and the side on which an obstacle is passed can depend on it.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.fields import attraction, relative
from worker.engine.physics.vectors import Goal, Vector, difference, moved, norm, scaled


class GeCui(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 0.13
    eta: Annotated[float, Parameter("N m2", "Strength of the repulsion", 0.0, 1e9, symbol="η")] = 5.3
    rho_0: Annotated[float, Parameter("m", "Range of the repulsion, after braking", 1e-2, 1e5, symbol="ρ_0")] = 4.0
    A_max: Annotated[float, Parameter("m/s2", "Greatest deceleration", 1e-3, 1e3)] = 0.71
    floor: Annotated[float, Parameter("m", "Distance below which the repulsion is constant", 1e-6, 1e3)] = 0.1
    s: Annotated[float, Parameter("m", "Distance to the goal beyond which attraction is constant", 1e-3, 1e9)] = 1e9


@kernel
def repulsion(body: Any, v: tuple[float, float], p: GeCui) -> tuple[float, float]:
    vx = v[0] - body.vx
    vy = v[1] - body.vy
    closing = -(vx * body.nx + vy * body.ny)
    along, across = relative(body.gap, closing, p.eta, p.rho_0, p.A_max, p.floor)
    # n is the reversed normal
    return across * (vx + closing * body.nx) - along * body.nx, across * (vy + closing * body.ny) - along * body.ny


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Goal, bodies: Any, memory: tuple[()], p: GeCui
) -> tuple[Vector, tuple[()]]:
    way = difference(goal, q)
    force = scaled(attraction(norm(way), p.k_att, p.s), way)
    for body in bodies:
        force = moved(force, 1.0, repulsion(body, v, p))
    return force, ()


component = Avoider(
    name="ge_cui",
    title="Potential field for moving obstacles",
    dimension=2,
    demand="force",
    parameters=GeCui,
    goal=Goal,
    memory=0,
    steer=steer,
)
