"""Cylinder: a static upright cylinder between two heights.

The gap is the distance to its surface, negative inside; the normal points away from the nearest point of the surface
(inside: out of the nearest one of side, top and bottom). Its centre, to which `separation` measures distances, is the
nearest point of its axis: within its height the separation is the distance from the axis.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import clip, kernel, norm2
from worker.engine.kernels.views import Body3
from worker.engine.physics.shapes import outward, rectangle


class Cylinder(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Middle of the axis, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Middle of the axis, y", -1e6, 1e6, symbol="y", name="position.y")]
    position_z: Annotated[float, Parameter("m", "Middle of the axis, z", -1e6, 1e6, symbol="z", name="position.z")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 20.0
    height: Annotated[float, Parameter("m", "Height", 1e-3, 1e5, symbol="h")] = 100.0


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float, float], p: Cylinder) -> Body3:
    dx = q[0] - p.position_x
    dy = q[1] - p.position_y
    dz = q[2] - p.position_z
    half = 0.5 * p.height
    d = norm2(dx, dy)
    near = 1.0 / (d + 1e-12)
    gap, side, end = rectangle(d - p.radius, outward(dz, half))
    end = -end if dz < 0.0 else end
    z = p.position_z + clip(dz, -half, half)
    nx, ny = side * dx * near, side * dy * near
    return Body3(p.position_x, p.position_y, z, 0.0, 0.0, 0.0, p.radius, gap, nx, ny, end)


component = Obstacle(
    name="cylinder",
    title="Cylinder",
    dimension=3,
    parameters=Cylinder,
    body=body,
    reach=Reach(("radius",)),
    look=ObstacleLook(shape="cylinder", radius="radius", height="height"),
)
