"""Rolling resistance of the ground: a fraction of the weight, against the motion.

    F_r = -c m g  along the heading when rolling forwards

c is the coefficient of rolling resistance: 0.01 on a hard floor, 0.05 on grass, 0.2 in sand. Its effect is
part of the robot's model. It has no effect on aircraft.
Source: Wong, Theory of Ground Vehicles (2008); Srikanthakumar, section 1.2 (friction of different
surfaces).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Environment, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings


class GroundFriction(NamedTuple):
    c: Annotated[float, Parameter("", "Coefficient of rolling resistance", 0.0, 1.0)] = 0.0


@kernel
def blow(t: float, q: Any, v: Any, e: tuple[()], p: GroundFriction) -> tuple[Surroundings, tuple[()]]:
    return Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, p.c), ()


component = Environment(name="ground_friction", title="Rolling resistance", parameters=GroundFriction, blow=blow)
