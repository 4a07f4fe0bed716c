"""Actuator rate limit: an input cannot change faster than its rate.

    da/dt = clip(K (u - a), -R, R),   y = a + clip(u - a, -R/K, R/K)

u is the command, y what acts on the vehicle, R the rate in the input's own unit per second. While |du/dt| < R, y = u
exactly; beyond, y moves at R until it meets the command again. K sets how sharp that is: a jump of up to R/K passes.
It starts at the controller's first command, as before any fault. Keep K below 2.7 divided by the step.
Source: Srikanthakumar, step 3 of section 1.3 (hardware: actuator dynamics); Duda, Prediction of pilot-in-the-loop
oscillations due to rate saturation (J. Guidance, Control and Dynamics 20, 1997).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.components.faults.actuator_lag import rest
from worker.engine.kernels.component import Derived, Fault, Parameter
from worker.engine.kernels.maths import clip, kernel


class ActuatorRateLimit(NamedTuple):
    rate: Annotated[float, Parameter("1/s", "Rate in units of the input per second", 0.0, 1e9, symbol="R")] = 1e9
    K: Annotated[float, Parameter("1/s", "Rate at which the actuator approaches its command", 0.1, 1e4)] = 20.0


class Constants(NamedTuple):
    rate: float
    K: float
    reach: float


@kernel
def derive(p: ActuatorRateLimit, trim: object) -> tuple[float, float, float]:
    return p.rate, p.K, p.rate / p.K


@kernel
def act(t: float, u: float, a: tuple[float], p: Constants) -> tuple[float, tuple[float]]:
    ahead = u - a[0]
    limited = a[0] + clip(ahead, -p.reach, p.reach)
    return (limited if abs(ahead) > p.reach else u), (clip(p.K * ahead, -p.rate, p.rate),)


component = Fault(
    name="actuator_rate_limit",
    title="Actuator rate limit",
    path="actuator",
    parameters=ActuatorRateLimit,
    kernel=act,
    states=1,
    rest=rest,
    derived=Derived(Constants, derive),
)
