"""Sphere: a static spherical obstacle in space.

Avoiders keep clear of its radius; `separation` measures distances to its centre. Radius 0 is a point.
"""

from __future__ import annotations

from typing import Any

from worker.engine.components.obstacles import circle
from worker.engine.kernels.component import Obstacle, ObstacleLook, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.parameters import in_space
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.vectors import Vector, round_body

Sphere = in_space(circle.Circle, radius=20.0)


@kernel
def body(t: float, o: tuple[()], q: Vector, p: Any) -> Body | Body3:
    return round_body((p.position_x, p.position_y, p.position_z), (0.0, 0.0, 0.0), p.radius, q)


component = Obstacle(
    name="sphere",
    title="Sphere",
    dimension=3,
    parameters=Sphere,
    body=body,
    reach=Reach(("radius",)),
    look=ObstacleLook(shape="sphere", radius="radius"),
)
