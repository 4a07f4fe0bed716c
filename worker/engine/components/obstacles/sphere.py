"""Sphere: a static spherical obstacle in space.

Avoiders keep clear of its radius; `separation` measures distances to its centre. Radius 0 is a point.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body3
from worker.engine.physics.space import Vector, ball


class Sphere(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, symbol="y", name="position.y")]
    position_z: Annotated[float, Parameter("m", "Centre, z", -1e6, 1e6, symbol="z", name="position.z")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 20.0


@kernel
def body(t: float, o: tuple[()], q: Vector, p: Sphere) -> Body3:
    return ball((p.position_x, p.position_y, p.position_z), (0.0, 0.0, 0.0), p.radius, q)


component = Obstacle(
    name="sphere",
    title="Sphere",
    dimension=3,
    parameters=Sphere,
    body=body,
    reach=Reach(("radius",)),
    look=ObstacleLook(shape="sphere", radius="radius"),
)
