"""Circle: a static circular obstacle in the plane.

Avoiders keep clear of its radius; `separation` measures distances to its centre. Radius 0 is a point.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.kernels.views import Body


class Circle(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, symbol="y", name="position.y")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float], p: Circle) -> Body:
    dx = q[0] - p.position_x
    dy = q[1] - p.position_y
    d = norm2(dx, dy)
    near = d + 1e-12
    return Body(p.position_x, p.position_y, 0.0, 0.0, p.radius, d - p.radius, dx / near, dy / near)


component = Obstacle(
    name="circle",
    title="Circle",
    dimension=2,
    parameters=Circle,
    body=body,
    reach=Reach(("radius",)),
    look=ObstacleLook(shape="circle", radius="radius"),
)
