"""Stuck actuator: from a given time an input stays at its position.

    y = u + w (a - u),  da/dt = (1 - w) K (u - a),   w = 0 before `at`, growing to 1 within `over`

u is the command, y what acts on the vehicle, a the recorded position of the actuator, which lags the command by 1/K: it
sticks where a servo with that lag would be. With over = 0 it jumps there, at an instant that the integrator resolves to
half a step; two steps or more make the cost smooth in `at`. It starts at the controller's first command, as before
any fault. Keep K below 2.7 divided by the step, below 0.5 for accuracy. A surface that runs to its stop instead is
`hard_over`.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions); Boskovic and Mehra, Multiple-model adaptive flight
control scheme for accommodation of actuator failures (J. Guidance, Control and Dynamics 25, 2002): lock in place.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.components.faults.actuator_lag import rest
from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, onset
from worker.engine.physics import instants


class ActuatorStuck(NamedTuple):
    at: Annotated[float, Parameter("s", "Time at which it sticks", 0.0, 1e6)] = 1e6
    over: Annotated[float, Parameter("s", "Time over which it comes to rest", 0.0, 1e6)] = 0.0
    K: Annotated[float, Parameter("1/s", "Rate at which the record follows the command", 0.1, 1e4)] = 20.0


@kernel
def act(t: float, u: float, a: tuple[float], p: ActuatorStuck) -> tuple[float, tuple[float]]:
    stuck = onset(t, p.at, p.over)
    ahead = u - a[0]
    return u - stuck * ahead, ((1.0 - stuck) * p.K * ahead,)


component = Fault(
    name="actuator_stuck",
    title="Stuck actuator",
    path="actuator",
    parameters=ActuatorStuck,
    kernel=act,
    states=1,
    rest=rest,
    switches=instants.ramp,
    whole=1,
)
