"""Steady wind: constant, or changing linearly along the vertical axis.

    W = (x, y, z) + (shear_x, shear_y) (q_z - reference)

W is the velocity of the air in the world frame [m/s], q_z the vehicle's position on the world's z axis (down in NED, so
that a wind that grows with height has a shear against it). Aircraft start trimmed in still air, so it acts as a step
gust at t = 0. It has no effect on ground robots.
Source: Etkin, Dynamics of Atmospheric Flight (1972); Srikanthakumar, section 1.2 (wind as a change of the operation
environment).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Environment, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings


class SteadyWind(NamedTuple):
    x: Annotated[float, Parameter("m/s", "Wind, x", -100.0, 100.0, symbol="W_x")] = 0.0
    y: Annotated[float, Parameter("m/s", "Wind, y", -100.0, 100.0, symbol="W_y")] = 0.0
    z: Annotated[float, Parameter("m/s", "Wind, z", -100.0, 100.0, symbol="W_z")] = 0.0
    shear_x: Annotated[float, Parameter("1/s", "Change of the wind along z, x", -10.0, 10.0)] = 0.0
    shear_y: Annotated[float, Parameter("1/s", "Change of the wind along z, y", -10.0, 10.0)] = 0.0
    reference: Annotated[float, Parameter("m", "Position on the z axis where the wind is (x, y, z)", -1e6, 1e6)] = 0.0


@kernel
def blow(t: float, q: Any, v: Any, e: tuple[()], p: SteadyWind) -> tuple[Surroundings, tuple[()]]:
    along = q[2] - p.reference
    return Surroundings(p.x + p.shear_x * along, p.y + p.shear_y * along, p.z, 0.0, 0.0, 0.0), ()


component = Environment(name="steady_wind", title="Steady wind", parameters=SteadyWind, blow=blow)
