"""My avoider: attracted by the goal, turned aside by every obstacle that is near.

    F = k_goal (goal - q) + sum over obstacles of k_away max(0, 1 - d / reach) (n + n_perp)

d is the distance from the obstacle's surface, n the unit vector away from it, n_perp the same turned left: the vehicle
passes every obstacle with the obstacle on its right.
Source: none, an example; replace this line by your own source. This text is the help page of the component.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter
from worker.engine.kernels.maths import clip, kernel

Pair = tuple[float, float]


class MyAvoider(NamedTuple):
    k_goal: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e4)] = 1.0
    k_away: Annotated[float, Parameter("N", "Force away from an obstacle at its surface", 0.0, 1e6)] = 30.0
    reach: Annotated[float, Parameter("m", "Distance from the surface at which it begins", 0.01, 1e4)] = 3.0


class Goal(NamedTuple):
    # Where the vehicle is to go, as a campaign gives it under `goal`.
    x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6)]
    y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6)]


@kernel
def steer(
    t: float, q: Pair, v: Pair, goal: Goal, bodies: Any, memory: tuple[()], p: MyAvoider
) -> tuple[Pair, tuple[()]]:
    # q, v: position and velocity as measured; bodies: the obstacles as perceived (worker/engine/kernels/views.py).
    x, y = p.k_goal * (goal.x - q[0]), p.k_goal * (goal.y - q[1])
    for body in bodies:
        away = p.k_away * clip(1.0 - body.gap / p.reach, 0.0, 1.0)
        x += away * (body.nx - body.ny)
        y += away * (body.ny + body.nx)
    return (x, y), ()  # the demand, and the new memory: () without one


@kernel
def remember(p: MyAvoider) -> tuple[()]:
    # The memory at the start; with memory=1 below, a tuple of one number.
    return ()


component = Avoider(
    name="my_avoider",
    title="My avoider",
    dimension=2,
    demand="force",  # or velocity: what the result of `steer` is
    parameters=MyAvoider,
    goal=Goal,
    memory=0,
    steer=steer,
    remember=remember,
)
