"""Position error of perception: obstacles are detected at displaced positions.

    seen position = true position + (dx, dy, dz)

Constant, and the same for every obstacle; shape and velocity are measured correctly. Displacements are in the world
frame; dz has no effect in the plane.
Source: Srikanthakumar, section 3.3.6 (P_x0 = x_0 + dx, P_y0 = y_0 + dy).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Sight


class PositionError(NamedTuple):
    dx: Annotated[float, Parameter("m", "Error of the obstacle's position, x", -1e6, 1e6, symbol="Δx")] = 0.0
    dy: Annotated[float, Parameter("m", "Error of the obstacle's position, y", -1e6, 1e6, symbol="Δy")] = 0.0
    dz: Annotated[float, Parameter("m", "Error of the obstacle's position, z", -1e6, 1e6, symbol="Δz")] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: PositionError) -> Sight:
    return Sight(p.dx, p.dy, p.dz, 0.0, 0.0, 0.0, 1.0)


component = Fault(
    name="position_error",
    title="Position error",
    path="perception",
    parameters=PositionError,
    kernel=see,
)
