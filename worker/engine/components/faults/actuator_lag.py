"""Actuator lag: an input follows its command with a first-order lag.

    tau dy/dt = u - y

u is the command, y what acts on the vehicle, tau the time constant. It starts settled on the
controller's first command, as before any fault.
Below the time constant `shortest` the integrator's step could not follow: there y = (1 - s) u + s a with a lagging by
`shortest` and s = tau / shortest, which delays slow commands by the same tau and is continuous down to tau = 0.
Keep `shortest` above the step: Runge-Kutta is stable for steps below 2.7 tau.
Source: Srikanthakumar, step 3 of section 1.3 (hardware: actuator dynamics); Nelson, Flight Stability and Automatic
Control (1998): servo as a first-order lag.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Derived, Fault, Parameter
from worker.engine.kernels.maths import kernel


class ActuatorLag(NamedTuple):
    tau: Annotated[float, Parameter("s", "Time constant", 0.0, 1e3, symbol="τ")] = 0.0
    shortest: Annotated[float, Parameter("s", "Smallest time constant that is integrated", 1e-4, 10.0)] = 0.05


class Constants(NamedTuple):
    per_tau: float
    share: float


@kernel
def derive(p: ActuatorLag, trim: object) -> tuple[float, float]:
    tau = p.tau if p.tau > p.shortest else p.shortest
    return 1.0 / tau, p.tau / tau


@kernel
def act(t: float, u: float, a: tuple[float], p: Constants) -> tuple[float, tuple[float]]:
    behind = a[0] - u
    return u + p.share * behind, (-p.per_tau * behind,)


@kernel
def rest(u: float, p: Any) -> tuple[float]:
    return (u,)


component = Fault(
    name="actuator_lag",
    title="Actuator lag",
    path="actuator",
    parameters=ActuatorLag,
    kernel=act,
    states=1,
    rest=rest,
    derived=Derived(Constants, derive),
)
