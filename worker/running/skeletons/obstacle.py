"""My obstacle: a disc that swings to and fro along y.

    y(t) = y_0 + a sin(2 pi t / T)

This text is the help page of the component: replace it by your own.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Rate, Reach
from worker.engine.kernels.maths import TWO_PI, kernel, norm2, sincos
from worker.engine.kernels.views import Body


class MyObstacle(NamedTuple):
    # `name` is the name in a campaign: position.x in place of position_x. Without a default it must be given there.
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, symbol="x", name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y, in the middle", -1e6, 1e6, symbol="y_0", name="position.y")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e4, symbol="r")] = 0.5
    swing: Annotated[float, Parameter("m", "Amplitude", 0.0, 1e4, symbol="a")] = 1.0
    period: Annotated[float, Parameter("s", "Period", 0.1, 1e4, symbol="T")] = 10.0


@kernel
def body(t: float, o: tuple[()], q: tuple[float, float], p: MyObstacle) -> Body:
    # The obstacle as seen from q: centre, velocity, radius; distance to its surface, and the unit vector away from it.
    turn = TWO_PI / p.period
    s, c = sincos(turn * t)
    x, y, vy = p.position_x, p.position_y + p.swing * s, p.swing * turn * c
    dx, dy = q[0] - x, q[1] - y
    distance = norm2(dx, dy)
    per = 1.0 / (distance + 1e-12)  # never a division by zero, also at the centre
    return Body(x, y, 0.0, vy, p.radius, distance - p.radius, dx * per, dy * per)


component = Obstacle(
    name="my_obstacle",
    title="My obstacle",
    dimension=2,
    parameters=MyObstacle,
    body=body,
    moving=True,
    reach=Reach(("radius",)),  # from its centre to the farthest point of its surface
    rate=Rate(per=("period",), times=TWO_PI),  # how fast it turns [rad/s]
    look=ObstacleLook(shape="circle", radius="radius"),
)
