"""Latency of tracks: obstacles are detected at a past position, with their velocity at that time.

    seen(t) = obstacle(t - tau), extrapolated by compensation * tau along that velocity

With compensation 0 tracks are treated as current, as by a system without time stamps; 1 is dead reckoning over the
whole latency. Before t = tau the obstacle's trajectory is extended to before the start. Exact for obstacles with a
prescribed trajectory; one with its own states (a cooperative one) is moved back along its present velocity instead.
Static obstacles are not affected: `ranging_latency` is the case of relative measurements.
Source: Srikanthakumar, step 3 of section 1.3 (hardware: sensor dynamics, computing delays).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Seen


class Latency(NamedTuple):
    tau: Annotated[float, Parameter("s", "Age of the tracks", 0.0, 1e3, symbol="τ")] = 0.0
    compensation: Annotated[float, Parameter("", "Fraction of the latency that is compensated", 0.0, 1.0)] = 0.0


@kernel
def delay(t: float, p: Latency) -> Seen:
    return Seen(t - p.tau, p.compensation * p.tau)


component = Fault(name="latency", title="Latency of tracks", path="timing", parameters=Latency, kernel=delay)
