"""Artificial potential field in space: attracted by the goal, repelled by every obstacle nearby.

    F = k_att (goal - q) + sum over obstacles with d <= d_0 of k_rep (1/d - 1/d_0) / d^2 * n

d is the distance from the obstacle's surface, n the unit vector away from it: any number of obstacles of any shape.
Farther from the goal than s the attraction is conic: its force stays k_att s (2.7). Below d = 1 mm the repulsion keeps
its value at 1 mm.
Source: Khatib, Real-time obstacle avoidance for manipulators and mobile robots (1986), FIRAS; Srikanthakumar, equations
2.7, 2.8, 3.11, 3.13 and 3.45. Local minima and goals inside d_0 of an obstacle are known properties of the method;
close to an obstacle the force may reverse.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.fields import attraction, firas
from worker.engine.physics.vectors import SpatialGoal as Goal
from worker.engine.physics.vectors import Vector, difference, moved, norm, normal, scaled


class PotentialField(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 1.0
    k_rep: Annotated[float, Parameter("N m3", "Strength of the repulsion", 0.0, 1e12)] = 2e7
    d_0: Annotated[float, Parameter("m", "Distance from the surface at which repulsion begins", 1e-2, 1e5)] = 35.0
    s: Annotated[float, Parameter("m", "Distance to the goal beyond which attraction is constant", 1e-3, 1e9)] = 1e9


@kernel
def first(t: float, q: Vector, v: Vector, goal: Goal, memory: tuple[()], p: Any) -> Vector:
    way = difference(goal, q)
    return scaled(attraction(norm(way), p.k_att, p.s), way)


@kernel
def weigh(
    force: Vector, number: float, body: Any, t: float, q: Vector, v: Vector, goal: Goal, m: tuple[()], p: PotentialField
) -> Vector:
    away = firas(body.gap, p.k_rep, p.d_0)
    return moved(force, away, normal(body, q))


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Goal, force: Vector, memory: tuple[()], p: Any
) -> tuple[Vector, tuple[()]]:
    return force, ()


component = Avoider(
    name="potential_field_3d",
    title="Potential field",
    dimension=3,
    demand="force",
    parameters=PotentialField,
    goal=Goal,
    memory=0,
    steer=steer,
    weigh=weigh,
    first=first,
)
