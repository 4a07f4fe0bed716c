"""Velocity error of perception: obstacles are detected with wrong velocities.

    seen velocity = true velocity + (dvx, dvy, dvz)

Constant, and the same for every obstacle; positions are measured correctly. The world frame; dvz has no effect in the
plane. An avoider that uses no velocities is not affected.
Source: Srikanthakumar, step 3 of section 1.3 (sensor errors) and section 3.3.6 (V_v0 = v_obs + dv).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Sight


class VelocityError(NamedTuple):
    dvx: Annotated[float, Parameter("m/s", "Error of the obstacle's velocity, x", -1e3, 1e3, symbol="Δv_x")] = 0.0
    dvy: Annotated[float, Parameter("m/s", "Error of the obstacle's velocity, y", -1e3, 1e3, symbol="Δv_y")] = 0.0
    dvz: Annotated[float, Parameter("m/s", "Error of the obstacle's velocity, z", -1e3, 1e3, symbol="Δv_z")] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: VelocityError) -> Sight:
    return Sight(0.0, 0.0, 0.0, p.dvx, p.dvy, p.dvz, 1.0)


component = Fault(
    name="velocity_error", title="Velocity error", path="perception", parameters=VelocityError, kernel=see
)
