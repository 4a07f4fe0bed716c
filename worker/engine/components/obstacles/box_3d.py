"""Box in space: a static cuboid, turned by an angle about its vertical axis.

The gap is the distance to its surface, negative inside; the normal points away from the nearest point of the surface
(inside: out of the nearest face). Avoiders that handle only spheres use its circumscribed sphere. `separation`
measures distances to its centre.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import kernel, sincos
from worker.engine.kernels.views import Body3
from worker.engine.physics.shapes import cuboid, outward


class Box3(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, symbol="y", name="position.y")]
    position_z: Annotated[float, Parameter("m", "Centre, z", -1e6, 1e6, symbol="z", name="position.z")]
    length: Annotated[float, Parameter("m", "Length, along its own x axis", 1e-3, 1e5)] = 40.0
    width: Annotated[float, Parameter("m", "Width, along its own y axis", 1e-3, 1e5)] = 40.0
    height: Annotated[float, Parameter("m", "Height, along z", 1e-3, 1e5)] = 100.0
    angle: Annotated[float, Parameter("rad", "Angle of its own x axis, from x towards y", -6.4, 6.4, "α")] = 0.0


class Constants(NamedTuple):
    x: float
    y: float
    z: float
    half_x: float
    half_y: float
    half_z: float
    sin: float
    cos: float
    radius: float


@kernel
def derive(p: Box3, trim: object) -> tuple[float, ...]:
    s, c = sincos(p.angle)
    radius = 0.5 * math.sqrt(p.length * p.length + p.width * p.width + p.height * p.height)
    half_x, half_y, half_z = 0.5 * p.length, 0.5 * p.width, 0.5 * p.height
    return p.position_x, p.position_y, p.position_z, half_x, half_y, half_z, s, c, radius


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float, float], p: Constants) -> Body3:
    dx = q[0] - p.x
    dy = q[1] - p.y
    z = q[2] - p.z
    x = dx * p.cos + dy * p.sin
    y = dy * p.cos - dx * p.sin
    gap, nx, ny, nz = cuboid(outward(x, p.half_x), outward(y, p.half_y), outward(z, p.half_z))
    nx = -nx if x < 0.0 else nx
    ny = -ny if y < 0.0 else ny
    nz = -nz if z < 0.0 else nz
    world_x = nx * p.cos - ny * p.sin
    world_y = nx * p.sin + ny * p.cos
    return Body3(p.x, p.y, p.z, 0.0, 0.0, 0.0, p.radius, gap, world_x, world_y, nz)


component = Obstacle(
    name="box_3d",
    title="Box in space",
    dimension=3,
    parameters=Box3,
    body=body,
    derived=Derived(Constants, derive),
    reach=Reach(("length", "width", "height"), 0.5),
    look=ObstacleLook(shape="box", height="height", sides=("length", "width"), angle="angle"),
)
