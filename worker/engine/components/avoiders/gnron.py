"""Potential field in the plane whose goal stays reachable next to an obstacle (GNRON).

    U_rep = 1/2 k_rep (1/d - 1/d_0)^2 g^n   for d <= d_0,   g = |goal - q|
    F = k_att (goal - q) + sum over obstacles of
        k_rep (1/d - 1/d_0) g^n / d^2 * normal  +  n/2 k_rep (1/d - 1/d_0)^2 g^(n-1) * unit vector to the goal

d is the distance from the obstacle's surface, normal the unit vector away from it: any number of obstacles of any
shape. Farther from the goal than s the attraction is conic: its force stays k_att s (2.7). Below d = 1 mm the
repulsion keeps its value at 1 mm.
Source: Ge and Cui, New potential functions for mobile robot path planning (2000); Srikanthakumar, equations 2.7 and
2.9. n is 0, 1, 2 or 3; 0 is FIRAS (2.8). With n >= 1 the repulsion vanishes at the goal, which FIRAS does not
do; local minima remain.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.fields import attraction, gnron
from worker.engine.physics.vectors import Goal, Vector, difference, moved, norm, normal, scaled


class Gnron(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 5.0
    k_rep: Annotated[float, Parameter("N m3/(m^n)", "Strength of the repulsion", 0.0, 1e12)] = 4.0
    d_0: Annotated[float, Parameter("m", "Distance from the surface at which repulsion begins", 1e-2, 1e5)] = 2.0
    n: Annotated[float, Parameter("", "Power of the distance to the goal: 0, 1, 2 or 3, rounded", 0.0, 3.0)] = 2.0
    s: Annotated[float, Parameter("m", "Distance to the goal beyond which attraction is constant", 1e-3, 1e9)] = 1e9


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Goal, bodies: Any, memory: tuple[()], p: Gnron
) -> tuple[Vector, tuple[()]]:
    way = difference(goal, q)
    g = norm(way)
    to_goal = attraction(g, p.k_att, p.s)
    force = scaled(0.0, way)
    for body in bodies:
        away, back = gnron(body.gap, g, p.k_rep, p.d_0, p.n)
        force = moved(force, away, normal(body, q))
        to_goal += back
    return moved(force, to_goal, way), ()


component = Avoider(
    name="gnron",
    title="Potential field, goal reachable near obstacles",
    dimension=2,
    demand="force",
    parameters=Gnron,
    goal=Goal,
    memory=0,
    steer=steer,
)
