"""Dropout of tracks: for an interval there are no new ones, and the last known ones are held or extrapolated.

    seen(t) = obstacle(at), extrapolated by coasting * (t - at) along its velocity then,   at <= t < at + duration

coasting = 0 holds position and velocity as last known, 1 is dead reckoning, as trackers do. Afterwards tracks are
current again. Exact for obstacles with a prescribed trajectory; one with its own states (a cooperative one) is moved
back along its present velocity instead. Static obstacles are not affected: use `blackout` to lose all obstacles. With
continuous guidance the integrator resolves its edges to half a step.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions of the sensors).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import INSTANT, kernel
from worker.engine.kernels.views import Seen
from worker.engine.physics import instants


class Dropout(NamedTuple):
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0
    duration: Annotated[float, Parameter("s", "Duration", 0.0, 1e6)] = 0.0
    coasting: Annotated[float, Parameter("", "Fraction of the last velocity in the extrapolation", 0.0, 1.0)] = 0.0


@kernel
def delay(t: float, p: Dropout) -> Seen:
    now = t + INSTANT
    out = (now >= p.at) & (now < p.at + p.duration)
    return Seen(p.at if out else t, p.coasting * (t - p.at) if out else 0.0)


component = Fault(
    name="dropout",
    title="Dropout of tracks",
    path="timing",
    parameters=Dropout,
    kernel=delay,
    switches=instants.interval,
)
