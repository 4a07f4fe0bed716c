"""Navigation bias: constant errors of the vehicle's own position, heading and speed.

    believed = true + (dx, dy, dz), heading + dpsi, speed + du

Controller and avoider use the estimated values; the criterion uses the true ones. The speed error applies to the
vehicle's own speed (its forward speed). Constant for the whole simulation.
Source: Srikanthakumar, section 7.5 (u_A = u + du, psi = psi + dpsi) and step 3 of section 1.3.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Errors


class NavigationBias(NamedTuple):
    dx: Annotated[float, Parameter("m", "Error of the own position, x", -1e5, 1e5, symbol="Δx")] = 0.0
    dy: Annotated[float, Parameter("m", "Error of the own position, y", -1e5, 1e5, symbol="Δy")] = 0.0
    dz: Annotated[float, Parameter("m", "Error of the own position, z", -1e5, 1e5, symbol="Δz")] = 0.0
    dpsi: Annotated[float, Parameter("rad", "Error of the own heading, from x towards y", -3.2, 3.2, symbol="Δψ")] = 0.0
    du: Annotated[float, Parameter("m/s", "Error of the own speed", -1e3, 1e3, symbol="Δu")] = 0.0


@kernel
def mistake(t: float, p: NavigationBias) -> Errors:
    return Errors(p.dx, p.dy, p.dz, p.dpsi, p.du)


component = Fault(
    name="navigation_bias", title="Navigation bias", path="navigation", parameters=NavigationBias, kernel=mistake
)
