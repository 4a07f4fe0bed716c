"""Circle: a static circular obstacle in the plane.

Its radius is what an avoider keeps off; the criterion reads distances to its centre. Radius 0 is a point.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.kernels.component import Obstacle, Parameter
from worker.kernels.glue import Body
from worker.kernels.maths import kernel


class Circle(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, symbol="y", name="position.y")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5


@kernel
def body(t: float, p: Circle) -> Body:
    return Body(p.position_x, p.position_y, 0.0, 0.0, p.radius)


component = Obstacle(name="circle", title="Circle", dimension=2, parameters=Circle, body=body)
