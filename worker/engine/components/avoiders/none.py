"""No avoidance in the plane: attracted by the goal only, regardless of obstacles.

    F = k_att (goal - q)                          within the distance s of the goal
    F = k_att s (goal - q) / |goal - q|           farther away

Source: Srikanthakumar, equations 2.5 to 2.7 and 3.29, k_att = 2 k_a; the second line is the conic part, whose force
does not grow with the distance. A baseline that shows the encounter without avoidance.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.fields import attraction
from worker.engine.physics.vectors import Goal, Vector, difference, norm, scaled


class Attraction(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 1.0
    s: Annotated[float, Parameter("m", "Distance to the goal beyond which attraction is constant", 1e-3, 1e9)] = 1e9


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Goal, bodies: Any, memory: tuple[()], p: Attraction
) -> tuple[Vector, tuple[()]]:
    way = difference(goal, q)
    return scaled(attraction(norm(way), p.k_att, p.s), way), ()


component = Avoider(
    name="none",
    title="No avoidance",
    dimension=2,
    demand="force",
    parameters=Attraction,
    goal=Goal,
    memory=0,
    steer=steer,
)
