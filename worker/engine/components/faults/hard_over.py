"""Hard-over: from a given time an input runs to a fixed value and stays there.

    y = u + w (value - u),   w = 0 before `at`, growing to 1 within `over`

u is the command, y what acts on the vehicle. The value is usually a stop of the actuator.
With over = 0 it jumps, at an instant that the integrator resolves to half a step.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions); Boskovic and Mehra, Multiple-model adaptive flight
control scheme for accommodation of actuator failures (J. Guidance, Control and Dynamics 25, 2002): hard-over failure.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, onset
from worker.engine.physics import instants


class HardOver(NamedTuple):
    at: Annotated[float, Parameter("s", "Start time", 0.0, 1e6)] = 1e6
    over: Annotated[float, Parameter("s", "Time to reach the value", 0.0, 1e6)] = 0.0
    value: Annotated[float, Parameter("", "Value it runs to, in the input's unit", -1e6, 1e6)] = 0.0


@kernel
def act(t: float, u: float, a: tuple[()], p: HardOver) -> tuple[float, tuple[()]]:
    return u + onset(t, p.at, p.over) * (p.value - u), ()


component = Fault(
    name="hard_over",
    title="Hard-over",
    path="actuator",
    parameters=HardOver,
    kernel=act,
    switches=instants.ramp,
    whole=1,
)
