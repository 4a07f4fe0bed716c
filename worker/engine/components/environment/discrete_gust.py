"""Discrete gust: the wind rises as a half cosine, holds, and falls the same way.

    W = (x, y, z) (1 - cos(pi r)) / 2,   r = 0 before `at`, growing to 1 within `rise`, 1 for `hold`, then falling

W is the velocity of the air in the world frame [m/s]. With hold = 0 it is the "1 - cosine" gust of twice `rise`.
The shape is given in time, not along the flight path: a vehicle at speed V meets a gust of length V rise.
Source: MIL-F-8785C and MIL-HDBK-1797 (discrete gust model); Srikanthakumar, section 1.2 (wind).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Environment, Parameter
from worker.engine.kernels.maths import PI, kernel, onset, sincos
from worker.engine.kernels.views import Surroundings


class DiscreteGust(NamedTuple):
    x: Annotated[float, Parameter("m/s", "Gust, x", -100.0, 100.0)] = 0.0
    y: Annotated[float, Parameter("m/s", "Gust, y", -100.0, 100.0)] = 0.0
    z: Annotated[float, Parameter("m/s", "Gust, z", -100.0, 100.0)] = 0.0
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0
    rise: Annotated[float, Parameter("s", "Time to its full speed", 1e-3, 1e6)] = 1.0
    hold: Annotated[float, Parameter("s", "Time at its full speed", 0.0, 1e6)] = 0.0


@kernel
def blow(t: float, q: Any, v: Any, e: tuple[()], p: DiscreteGust) -> tuple[Surroundings, tuple[()]]:
    up = onset(t, p.at, p.rise)
    down = onset(t, p.at + p.rise + p.hold, p.rise)
    _, c = sincos(PI * (up - down))
    share = 0.5 - 0.5 * c
    return Surroundings(share * p.x, share * p.y, share * p.z, 0.0, 0.0, 0.0), ()


def switches(p: DiscreteGust, horizon: float) -> list[float]:
    full = p.at + p.rise
    return [p.at, full, full + p.hold, full + p.hold + p.rise]


component = Environment(
    name="discrete_gust", title="Discrete gust", parameters=DiscreteGust, blow=blow, switches=switches, whole=1
)
