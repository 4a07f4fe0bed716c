"""Obstacles that set off late, go back, or turn about a fixed centre: a train between two points, and a jib."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Obstacle, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.views import Body
from worker.engine.physics.shapes import outward, rectangle
from worker.engine.physics.vectors import round_body
from worker.running.catalogue.installed import components

NEVER = 1e6


class Train(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Start, x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "Start, y", -1e6, 1e6, name="position.y")]
    goal_x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6, name="goal.x")]
    goal_y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6, name="goal.y")]
    speed: Annotated[float, Parameter("m/s", "Speed", 0.0, 1e3)] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e3)] = 0.1
    at: Annotated[float, Parameter("s", "Departure", -1e6, 1e6)] = 0.0
    back: Annotated[float, Parameter("s", "Departure from the goal", 0.0, 1e6)] = NEVER


@kernel
def train(t: float, o: tuple[()], q: Any, p: Train) -> Any:
    dx, dy = p.goal_x - p.position_x, p.goal_y - p.position_y
    takes = norm2(dx, dy) / (p.speed + 1e-12)
    there, returned = (t - p.at) / takes, (t - p.back) / takes
    there, returned = min(max(there, 0.0), 1.0), min(max(returned, 0.0), 1.0)
    along = there - returned
    return round_body((p.position_x + along * dx, p.position_y + along * dy), (0.0, 0.0), p.radius, q)


class Jib(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Pivot, x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "Pivot, y", -1e6, 1e6, name="position.y")]
    radius: Annotated[float, Parameter("m", "Half the width", 1e-3, 1e5)] = 0.1
    length: Annotated[float, Parameter("m", "Length", 1e-3, 1e5)] = 12.0
    omega: Annotated[float, Parameter("rad/s", "Turn rate", -10.0, 10.0)] = 0.02
    at: Annotated[float, Parameter("s", "Start", 0.0, 1e6)] = 0.0


@kernel
def jib(t: float, o: tuple[()], q: Any, p: Jib) -> Any:
    sin, cos = sincos(p.omega * max(t - p.at, 0.0))
    dx, dy = q[0] - p.position_x, q[1] - p.position_y
    gap, nx, ny = rectangle(outward(dx * cos + dy * sin, 0.5 * p.length), outward(dy * cos - dx * sin, p.radius))
    return Body(p.position_x, p.position_y, 0.0, 0.0, 0.5 * p.length, gap, nx * cos - ny * sin, nx * sin + ny * cos)


LEGS = Rate(("speed",), legs=("position", "goal"))
TRAIN = Obstacle("train", "Train", 2, Train, train, moving=True, reach=Reach(("radius",)), rate=LEGS)
JIB = Obstacle("jib", "Jib", 2, Jib, jib, moving=True, reach=Reach(("length",), 0.52), rate=Rate(("omega",)))
ORBIT: Any = components()["obstacle", "orbiting_circle"]
