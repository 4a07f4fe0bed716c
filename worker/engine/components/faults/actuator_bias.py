"""Actuator bias: from a given time an input is off by a constant.

    y = u + w bias,   w = 0 before `at`, growing to 1 within `over`

u is the command, y what acts on the vehicle; bias in the input's own unit (a misrigged surface, an unequal motor).
With over = 0 it jumps, at an instant that the integrator resolves to half a step.
Source: Srikanthakumar, step 3 of section 1.3 (hardware tolerances).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, onset
from worker.engine.physics import instants


class ActuatorBias(NamedTuple):
    bias: Annotated[float, Parameter("", "Offset in the input's unit", -1e6, 1e6)] = 0.0
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 0.0
    over: Annotated[float, Parameter("s", "Time over which it builds up", 0.0, 1e6)] = 0.0


@kernel
def act(t: float, u: float, a: tuple[()], p: ActuatorBias) -> tuple[float, tuple[()]]:
    return u + onset(t, p.at, p.over) * p.bias, ()


component = Fault(
    name="actuator_bias",
    title="Actuator bias",
    path="actuator",
    parameters=ActuatorBias,
    kernel=act,
    switches=instants.ramp,
    whole=1,
)
