"""Artificial potential field in the plane: attracted by the goal, repelled by every obstacle nearby (FIRAS).

    F = k_att (goal - q) + sum over obstacles with d <= d_0 of k_rep (1/d - 1/d_0) / d^2 * n

d is the distance from the obstacle's surface, n the unit vector away from it: any number of obstacles of any shape.
Below d = 1 mm the repulsion keeps its value at 1 mm, so it is finite everywhere. The attraction is quadratic and not
limited far from the goal; with a conic one this is `gnron` with n = 0.
Source: Khatib, Real-time obstacle avoidance for manipulators and mobile robots (1986); Srikanthakumar, equations 3.11
(attraction), 2.8 and 3.13 (repulsion). Local minima and goals inside d_0 of an obstacle are known properties of the
method.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.fields import firas
from worker.engine.physics.vectors import Goal


class PotentialField(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 5.0
    k_rep: Annotated[float, Parameter("N m3", "Strength of the repulsion", 0.0, 1e9)] = 4.0
    d_0: Annotated[float, Parameter("m", "Distance from the surface at which repulsion begins", 1e-2, 1e5)] = 2.0


@kernel
def steer(
    t: float,
    q: tuple[float, float],
    v: tuple[float, float],
    goal: Goal,
    bodies: Any,
    memory: tuple[()],
    p: PotentialField,
) -> tuple[tuple[float, float], tuple[()]]:
    fx = p.k_att * (goal.x - q[0])
    fy = p.k_att * (goal.y - q[1])
    for body in bodies:
        strength = firas(body.gap, p.k_rep, p.d_0)
        fx += strength * body.nx
        fy += strength * body.ny
    return (fx, fy), ()


component = Avoider(
    name="potential_field",
    title="Potential field",
    dimension=2,
    demand="force",
    parameters=PotentialField,
    goal=Goal,
    memory=0,
    steer=steer,
)
