"""Slope of the ground: the same everywhere.

    dz/dx = x,  dz/dy = y        (rise per metre along the world's axes; 0.1 is 10 %)

Its effect is part of the robot's model: gravity along its heading. The criterion's distances remain those in the plane.
It has no effect on aircraft.
Source: Srikanthakumar, section 1.2 and step 3 of section 1.3 (changes of the operation environment).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Environment, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings


class GroundSlope(NamedTuple):
    x: Annotated[float, Parameter("", "Rise per metre along x", -1.0, 1.0, symbol="s_x")] = 0.0
    y: Annotated[float, Parameter("", "Rise per metre along y", -1.0, 1.0, symbol="s_y")] = 0.0


@kernel
def blow(t: float, q: Any, v: Any, e: tuple[()], p: GroundSlope) -> tuple[Surroundings, tuple[()]]:
    return Surroundings(0.0, 0.0, 0.0, p.x, p.y, 0.0), ()


component = Environment(name="ground_slope", title="Slope of the ground", parameters=GroundSlope, blow=blow)
