"""Slope of the ground: the same everywhere.

    dz/dx = x,  dz/dy = y        (rise per metre along the ground: the sine of its angle, so 0.1 is 5.7 degrees)

Its effect is part of the robot's model: gravity along its heading, g times the rise per metre. All positions, and the
criterion's distances, are measured along the ground, where this is exact. Not included: rolling resistance is that of
level ground, 0.5 % too much at 0.1 and 29 % at 0.7. It has no effect on aircraft.
Source: Srikanthakumar, section 1.2 and step 3 of section 1.3 (changes of the operation environment).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Environment, Order, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings


class GroundSlope(NamedTuple):
    x: Annotated[float, Parameter("", "Rise per metre of ground along x", -1.0, 1.0, symbol="s_x")] = 0.0
    y: Annotated[float, Parameter("", "Rise per metre of ground along y", -1.0, 1.0, symbol="s_y")] = 0.0


@kernel
def blow(t: float, q: Any, v: Any, e: tuple[()], p: GroundSlope) -> tuple[Surroundings, tuple[()]]:
    return Surroundings(0.0, 0.0, 0.0, p.x, p.y, 0.0), ()


STEEPEST = 0.5
STEEP = "beyond 45 degrees along each axis the ground could be steeper than a wall; give a smaller slope"

component = Environment(
    name="ground_slope",
    title="Slope of the ground",
    parameters=GroundSlope,
    blow=blow,
    orders=tuple(Order((axis, axis), (), STEEP, STEEPEST) for axis in "xy"),
)
