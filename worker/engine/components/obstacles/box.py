"""Box: a static rectangle in the plane, turned by an angle about its centre.

The gap is the distance to its edge, negative inside; the normal points away from the nearest point of the edge (inside:
out of the nearest side). Avoiders that handle only discs use its circumscribed circle. `separation` measures
distances to its centre.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.views import Body
from worker.engine.physics.shapes import outward, rectangle


class Box(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, symbol="y", name="position.y")]
    length: Annotated[float, Parameter("m", "Length, along its own x axis", 1e-3, 1e5)] = 2.0
    width: Annotated[float, Parameter("m", "Width, along its own y axis", 1e-3, 1e5)] = 1.0
    angle: Annotated[float, Parameter("rad", "Angle of its own x axis", -6.4, 6.4, symbol="α")] = 0.0


class Constants(NamedTuple):
    x: float
    y: float
    half_x: float
    half_y: float
    sin: float
    cos: float
    radius: float


@kernel
def derive(p: Box, trim: object) -> tuple[float, ...]:
    s, c = sincos(p.angle)
    return p.position_x, p.position_y, 0.5 * p.length, 0.5 * p.width, s, c, 0.5 * norm2(p.length, p.width)


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float], p: Constants) -> Body:
    dx = q[0] - p.x
    dy = q[1] - p.y
    x = dx * p.cos + dy * p.sin
    y = dy * p.cos - dx * p.sin
    gap, nx, ny = rectangle(outward(x, p.half_x), outward(y, p.half_y))
    nx = -nx if x < 0.0 else nx
    ny = -ny if y < 0.0 else ny
    return Body(p.x, p.y, 0.0, 0.0, p.radius, gap, nx * p.cos - ny * p.sin, nx * p.sin + ny * p.cos)


component = Obstacle(
    name="box",
    title="Box",
    dimension=2,
    parameters=Box,
    body=body,
    derived=Derived(Constants, derive),
    reach=Reach(("length", "width"), 0.5),
    look=ObstacleLook(shape="rectangle", sides=("length", "width"), angle="angle"),
)
