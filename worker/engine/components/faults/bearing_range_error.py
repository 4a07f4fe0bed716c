"""Bearing and range error: a sensor that measures angles and distance displaces obstacles.

    seen = q + (1 + k + dr/r) Rot(db, de) (c - q),   r = |c - q|

c is the obstacle's centre, q the vehicle's own estimated position. db turns the line of sight from the x to the y axis,
de tilts it towards the z axis (down in NED); k is the error of the range's scale, dr its bias. The whole obstacle is
displaced with its centre, so at a given angle the error grows with distance. Its velocity is measured correctly.
Source: error model of a ranging sensor, as Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and
Navigation (2001); Srikanthakumar, step 3 of section 1.3 asks for sensor errors.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.views import Sight


class BearingRangeError(NamedTuple):
    db: Annotated[float, Parameter("rad", "Error of the bearing, from x towards y", -3.2, 3.2, symbol="Δb")] = 0.0
    de: Annotated[float, Parameter("rad", "Error of the elevation, towards z", -1.6, 1.6, symbol="Δe")] = 0.0
    dr: Annotated[float, Parameter("m", "Bias of the range", -1e5, 1e5, symbol="Δr")] = 0.0
    k: Annotated[float, Parameter("", "Error of the range's scale", -1.0, 10.0)] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: BearingRangeError) -> Sight:
    x = body.x - own[0]
    y = body.y - own[1]
    z = body.z - own[2]
    h = norm2(x, y)
    # Written as differences from the truth, which are exactly 0 without errors.
    se, ce = sincos(p.de)
    outward = (h * (ce - 1.0) - z * se) / (h + 1e-12)
    tilted_x = x + outward * x
    tilted_y = y + outward * y
    tilted_z = z + (z * (ce - 1.0) + h * se)
    s, c = sincos(p.db)
    seen_x = c * tilted_x - s * tilted_y
    seen_y = s * tilted_x + c * tilted_y
    longer = p.k + p.dr / (norm2(h, z) + 1e-12)
    return Sight(
        (seen_x - x) + longer * seen_x,
        (seen_y - y) + longer * seen_y,
        (tilted_z - z) + longer * tilted_z,
        0.0,
        0.0,
        0.0,
        1.0,
    )


component = Fault(
    name="bearing_range_error",
    title="Bearing and range error",
    path="perception",
    parameters=BearingRangeError,
    kernel=see,
)
