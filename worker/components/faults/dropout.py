"""Dropout of tracks: for an interval no new ones come, and the last known ones are held or carried on.

    seen(t) = obstacle(at), carried on by coasting * (t - at) along its velocity then,   at <= t < at + duration

coasting = 0 holds position and velocity as last known, 1 is dead reckoning, as trackers do. Afterwards all is current
again. Exact for obstacles whose course is known in time; one with states of its own (a cooperative one) is taken back
along its present velocity instead. Standing obstacles are not affected: `blackout` is the case of seeing nothing. With
continuous guidance the integrator meets its edges to half a step.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions of the sensors).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.kernels.component import Fault, Parameter
from worker.kernels.maths import INSTANT, kernel
from worker.kernels.views import Seen


class Dropout(NamedTuple):
    at: Annotated[float, Parameter("s", "When it begins", 0.0, 1e6)] = 0.0
    duration: Annotated[float, Parameter("s", "How long it lasts", 0.0, 1e6)] = 0.0
    coasting: Annotated[float, Parameter("", "Share of the last velocity with which tracks go on", 0.0, 1.0)] = 0.0


@kernel
def delay(t: float, p: Dropout) -> Seen:
    now = t + INSTANT
    out = (now >= p.at) & (now < p.at + p.duration)
    return Seen(p.at if out else t, p.coasting * (t - p.at) if out else 0.0)


def switches(p: Dropout, horizon: float) -> list[float]:
    return [p.at, p.at + p.duration]


component = Fault(
    name="dropout", title="Dropout of tracks", path="timing", parameters=Dropout, kernel=delay, switches=switches
)
