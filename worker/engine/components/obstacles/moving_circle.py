"""Circle on a straight path: starts at its position at t = 0, moves to its goal at constant speed, stops there.

    c(t) = position + speed t e,   e the unit vector to the goal, until it is reached

It never gives way. Avoiders keep clear of its radius; `separation` measures distances to its centre.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.paths import leg
from worker.engine.physics.vectors import round_body


class MovingCircle(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre at the start, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre at the start, y", -1e6, 1e6, symbol="y", name="position.y")]
    goal_x: Annotated[float, Parameter("m", "End of the path, x", -1e6, 1e6, symbol="x_g", name="goal.x")]
    goal_y: Annotated[float, Parameter("m", "End of the path, y", -1e6, 1e6, symbol="y_g", name="goal.y")]
    speed: Annotated[float, Parameter("m/s", "Speed", 0.0, 1e3, symbol="v_o")] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5


class Constants(NamedTuple):
    x: float
    y: float
    vx: float
    vy: float
    stop: float
    goal_x: float
    goal_y: float
    radius: float


@kernel
def derive(p: MovingCircle, trim: object) -> tuple[float, ...]:
    start, goal = (p.position_x, p.position_y, 0.0), (p.goal_x, p.goal_y, 0.0)
    vx, vy, _, _, stop = leg(start, goal, p.speed, 0.0, True)
    # 0 times the velocity: a NaN during the motion stays a NaN at its end
    return p.position_x, p.position_y, vx, vy, stop, p.goal_x + 0.0 * vx, p.goal_y + 0.0 * vy, p.radius


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float], p: Constants) -> Body | Body3:
    moving = t < p.stop
    x = p.x + p.vx * t
    y = p.y + p.vy * t
    x = x if moving else p.goal_x
    y = y if moving else p.goal_y
    vx = p.vx if moving else 0.0
    vy = p.vy if moving else 0.0
    return round_body((x, y), (vx, vy), p.radius, q)


component = Obstacle(
    name="moving_circle",
    title="Circle, straight path",
    dimension=2,
    parameters=MovingCircle,
    body=body,
    moving=True,
    derived=Derived(Constants, derive),
    reach=Reach(("radius",)),
    rate=Rate(("speed",), legs=("position", "goal"), stops="stop"),
    look=ObstacleLook(shape="circle", radius="radius", way="goal"),
)
