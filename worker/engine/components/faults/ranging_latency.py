"""Latency of a ranging sensor: the obstacle's position relative to the vehicle is out of date.

    seen = q(t) + c(t - tau) - q(t - tau)  ~  c(t) + (v - v_o) tau

c is the obstacle's centre and v_o its velocity, q and v the vehicle's own estimates. Even a static obstacle seems to
move along with the vehicle that approaches it. The approximation assumes constant velocities over tau: its error is
half the relative acceleration times tau^2. The velocity is measured correctly. `latency` is the case of tracks in the
world frame, which are late by the obstacle's own motion alone.
Source: Srikanthakumar, step 3 of section 1.3 (hardware: sensor dynamics, computing delays).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Sight


class RangingLatency(NamedTuple):
    tau: Annotated[float, Parameter("s", "Age of the relative position", 0.0, 1e3, symbol="τ")] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: RangingLatency) -> Sight:
    return Sight(p.tau * (v[0] - body.vx), p.tau * (v[1] - body.vy), p.tau * (v[2] - body.vz), 0.0, 0.0, 0.0, 1.0)


component = Fault(
    name="ranging_latency",
    title="Latency of a ranging sensor",
    path="perception",
    parameters=RangingLatency,
    kernel=see,
)
