"""Blackout: for an interval no obstacle is detected, and none is remembered.

    not seen  when  at <= t < at + duration

With continuous guidance the integrator resolves its edges to half a step. Related faults: `dropout` holds the
last known tracks, `missed_detection` loses single samples.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions of the sensors).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import INSTANT, kernel
from worker.engine.kernels.views import Sight
from worker.engine.physics import instants


class Blackout(NamedTuple):
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0
    duration: Annotated[float, Parameter("s", "Duration", 0.0, 1e6)] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: Blackout) -> Sight:
    now = t + INSTANT
    dark = (now >= p.at) & (now < p.at + p.duration)
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 if dark else 1.0)


component = Fault(
    name="blackout", title="Blackout", path="perception", parameters=Blackout, kernel=see, switches=instants.interval
)
