"""Loss of effectiveness: from a given time an input has less effect than commanded.

    y = u - w loss (u - about),   w = 0 before `at`, growing to 1 within `over`

u is the command, y what acts on the vehicle. loss = 1 leaves `about`, the value of the input that has no effect (the
trimmed deflection of a surface, 0 for a force).
With over = 0 it jumps, at an instant that the integrator resolves to half a step.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions, control power); Boskovic and Mehra, Multiple-model
adaptive flight control scheme for accommodation of actuator failures (J. Guidance, Control and Dynamics 25, 2002).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, onset
from worker.engine.physics import instants


class ActuatorLoss(NamedTuple):
    loss: Annotated[float, Parameter("", "Fraction of the effect that is lost", 0.0, 1.0)] = 0.0
    about: Annotated[float, Parameter("", "Value of the input that has no effect, in its unit", -1e6, 1e6)] = 0.0
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0
    over: Annotated[float, Parameter("s", "Time over which it builds up", 0.0, 1e6)] = 0.0


@kernel
def act(t: float, u: float, a: tuple[()], p: ActuatorLoss) -> tuple[float, tuple[()]]:
    return u - onset(t, p.at, p.over) * p.loss * (u - p.about), ()


component = Fault(
    name="actuator_loss",
    title="Loss of effectiveness",
    path="actuator",
    parameters=ActuatorLoss,
    kernel=act,
    switches=instants.ramp,
    whole=1,
)
