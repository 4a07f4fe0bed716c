"""Sphere on a straight path: moves at constant speed, heading and climb, and never gives way.

    c(t) = position + speed t (cos(climb) cos(heading), cos(climb) sin(heading), -sin(climb))

Axes with z down: heading from north (x) over east (y), a positive climb goes up. Avoiders keep clear of its
radius if they measure from the surface; `separation` measures distances to its centre.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.space import Vector, velocity_vector
from worker.engine.physics.vectors import round_body


class MovingSphere(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Start, north", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Start, east", -1e6, 1e6, symbol="y", name="position.y")]
    position_z: Annotated[float, Parameter("m", "Start, down", -1e6, 1e6, symbol="z", name="position.z")]
    speed: Annotated[float, Parameter("m/s", "Speed", 0.0, 1e3, symbol="u_0")] = 20.0
    heading: Annotated[float, Parameter("rad", "Heading, from north over east", -6.4, 6.4, symbol="ψ_0")] = 0.0
    climb: Annotated[float, Parameter("rad", "Climb angle", -1.5, 1.5, symbol="γ_0")] = 0.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 1.0


class Constants(NamedTuple):
    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    radius: float


@kernel
def derive(p: MovingSphere, trim: object) -> tuple[float, ...]:
    vx, vy, vz = velocity_vector(p.speed, p.heading, p.climb)
    return p.position_x, p.position_y, p.position_z, vx, vy, vz, p.radius


@kernel
def body(t: float, o: tuple[()], q: Vector, p: Constants) -> Body | Body3:
    return round_body((p.x + p.vx * t, p.y + p.vy * t, p.z + p.vz * t), (p.vx, p.vy, p.vz), p.radius, q)


component = Obstacle(
    name="moving_sphere",
    title="Sphere, straight path",
    dimension=3,
    parameters=MovingSphere,
    body=body,
    moving=True,
    derived=Derived(Constants, derive),
    reach=Reach(("radius",)),
    rate=Rate(times=0.0),
    frame="ned",
    look=ObstacleLook(shape="sphere", radius="radius", way="heading"),
)
