"""Orbiting sphere: its centre moves on a horizontal circle at constant speed, and along z at `climb`.

    c(t) = centre + (R cos phi, R sin phi, climb t),   phi = phase + speed t / R

phi is measured from x towards y: with z down that is clockwise seen from above, and a positive `climb` goes down. It
never gives way. Avoiders keep clear of its radius; `separation` measures distances to its own centre.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, NamedTuple

from worker.engine.components.obstacles import orbiting_circle
from worker.engine.kernels.component import Derived, ObstacleLook, Parameter, extended
from worker.engine.kernels.maths import kernel, sincos
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.vectors import Vector, round_body


class OrbitingSphere(NamedTuple):
    centre_x: Annotated[float, Parameter("m", "Centre of the path, x", -1e6, 1e6, symbol="x", name="centre.x")]
    centre_y: Annotated[float, Parameter("m", "Centre of the path, y", -1e6, 1e6, symbol="y", name="centre.y")]
    centre_z: Annotated[float, Parameter("m", "Centre of the path, z", -1e6, 1e6, symbol="z", name="centre.z")]
    way: Annotated[float, Parameter("m", "Radius of the path", 1e-3, 1e6, symbol="R")] = 200.0
    phase: Annotated[float, Parameter("rad", "Initial angle, from the x axis", -6.4, 6.4, "φ_0")] = 0.0
    speed: Annotated[float, Parameter("m/s", "Horizontal speed, positive from x towards y", -1e3, 1e3, "v_o")] = 20.0
    climb: Annotated[float, Parameter("m/s", "Speed along z", -1e3, 1e3, symbol="v_z")] = 0.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 25.0


Constants = extended("Constants", OrbitingSphere, orbiting_circle.Turning)


@kernel
def body(t: float, o: tuple[()], q: Vector, p: Any) -> Body | Body3:
    s, c = sincos(p.phase + p.rate * t)
    centre = (p.centre_x + p.way * c, p.centre_y + p.way * s, p.centre_z + p.climb * t)
    return round_body(centre, (-p.speed * s, p.speed * c, p.climb), p.radius, q)


component = replace(
    orbiting_circle.component,
    name="orbiting_sphere",
    title="Sphere, circular path",
    dimension=3,
    parameters=OrbitingSphere,
    body=body,
    derived=Derived(Constants, orbiting_circle.derive),
    look=ObstacleLook(shape="sphere", radius="radius", way="orbit"),
)
