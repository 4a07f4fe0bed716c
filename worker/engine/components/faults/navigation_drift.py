"""Navigation drift: the errors of position and heading grow with time, as without external fixes.

    believed = true + (vx, vy, vz) (t - at), heading + rate (t - at)   for t > at

Linear in time: constant velocity errors and a constant gyro bias. Before `at` there is no error.
Source: Titterton and Weston, Strapdown Inertial Navigation Technology (2004), growth of single errors;
Srikanthakumar, step 3 of section 1.3.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Errors


class NavigationDrift(NamedTuple):
    vx: Annotated[float, Parameter("m/s", "Drift of the own position, x", -1e3, 1e3)] = 0.0
    vy: Annotated[float, Parameter("m/s", "Drift of the own position, y", -1e3, 1e3)] = 0.0
    vz: Annotated[float, Parameter("m/s", "Drift of the own position, z", -1e3, 1e3)] = 0.0
    rate: Annotated[float, Parameter("rad/s", "Drift of the own heading, from x towards y", -10.0, 10.0)] = 0.0
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0


@kernel
def mistake(t: float, p: NavigationDrift) -> Errors:
    time = t - p.at if t > p.at else 0.0
    return Errors(p.vx * time, p.vy * time, p.vz * time, p.rate * time, 0.0)


def switches(p: NavigationDrift, horizon: float) -> list[float]:
    return [p.at]


component = Fault(
    name="navigation_drift",
    title="Navigation drift",
    path="navigation",
    parameters=NavigationDrift,
    kernel=mistake,
    switches=switches,
)
