"""No avoidance in space: keeps the planned speed, heading and climb, regardless of obstacles.

    V = speed (cos(climb) cos(heading), cos(climb) sin(heading), -sin(climb))

Axes with z down. A baseline that shows the encounter without avoidance.
Source: Srikanthakumar, section 7.4 and figure 7.4.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from worker.engine.kernels.component import Avoider
from worker.engine.kernels.maths import kernel
from worker.engine.physics.resolution import Plan
from worker.engine.physics.space import Vector, velocity_vector


class Nothing(NamedTuple):
    """No parameters."""


@kernel
def steer(
    t: float, q: Vector, v: Vector, goal: Plan, bodies: Any, memory: tuple[()], p: Nothing
) -> tuple[Vector, tuple[()]]:
    return velocity_vector(goal.speed, goal.heading, goal.climb), ()


component = Avoider(
    name="cruise_3d",
    title="No avoidance, constant velocity",
    dimension=3,
    demand="velocity",
    parameters=Nothing,
    goal=Plan,
    memory=0,
    steer=steer,
    frame="ned",
)
