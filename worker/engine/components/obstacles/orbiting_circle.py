"""Orbiting circle: its centre moves on a circle at constant speed, anticlockwise if the speed is positive.

    c(t) = centre + R (cos phi, sin phi),   phi = phase + speed t / R

It never gives way. Avoiders keep clear of its radius; `separation` measures distances to its own centre.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Rate, Reach, extended
from worker.engine.kernels.maths import kernel, sincos
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.vectors import round_body


class OrbitingCircle(NamedTuple):
    centre_x: Annotated[float, Parameter("m", "Centre of the path, x", -1e6, 1e6, symbol="x", name="centre.x")]
    centre_y: Annotated[float, Parameter("m", "Centre of the path, y", -1e6, 1e6, symbol="y", name="centre.y")]
    way: Annotated[float, Parameter("m", "Radius of the path", 1e-3, 1e6, symbol="R")] = 5.0
    phase: Annotated[float, Parameter("rad", "Initial angle, from the x axis", -6.4, 6.4, "φ_0")] = 0.0
    speed: Annotated[float, Parameter("m/s", "Speed, positive anticlockwise", -1e3, 1e3, symbol="v_o")] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5


class Turning(NamedTuple):
    rate: float


Constants = extended("Constants", OrbitingCircle, Turning)


@kernel
def derive(p: Any, trim: object) -> tuple[float, ...]:
    return *p[0:], p.speed / p.way


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float], p: Any) -> Body | Body3:
    s, c = sincos(p.phase + p.rate * t)
    return round_body((p.centre_x + p.way * c, p.centre_y + p.way * s), (-p.speed * s, p.speed * c), p.radius, q)


component = Obstacle(
    name="orbiting_circle",
    title="Circle, circular path",
    dimension=2,
    parameters=OrbitingCircle,
    body=body,
    moving=True,
    derived=Derived(Constants, derive),
    reach=Reach(("radius",)),
    rate=Rate(("speed",), ("way",)),
    look=ObstacleLook(shape="circle", radius="radius", way="orbit"),
)
