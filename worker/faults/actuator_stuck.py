"""Stuck actuator: from a time on an input stays where it was.

    before `at`: y = u,  da/dt = K (u - a);   from `at` on: y = a,  da/dt = 0

u is the command, y what acts on the vehicle, a the record of where the actuator is, which lags the command by 1/K: it
sticks where a servo with that lag would be, and jumps there. It starts at the first command. Keep K below 2.7 divided
by the step. A surface that runs to its stop instead is `hard_over`.
Source: Srikanthakumar, step 3 of section 1.3 (failure conditions); Boskovic and Mehra, Multiple-model adaptive flight
control scheme for accommodation of actuator failures (J. Guidance, Control and Dynamics 25, 2002): lock in place.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.kernels.component import Fault, Parameter
from worker.kernels.maths import INSTANT, kernel


class ActuatorStuck(NamedTuple):
    at: Annotated[float, Parameter("s", "When it sticks", 0.0, 1e6)] = 1e6
    K: Annotated[float, Parameter("1/s", "How fast the record follows the command", 0.1, 1e4)] = 20.0


@kernel
def act(t: float, u: float, a: tuple[float], p: ActuatorStuck) -> tuple[float, tuple[float]]:
    stuck = t + INSTANT >= p.at
    rate = p.K * (u - a[0])
    return (a[0] if stuck else u), (0.0 if stuck else rate,)


@kernel
def rest(u: float, p: ActuatorStuck) -> tuple[float]:
    return (u,)


def switches(p: ActuatorStuck, horizon: float) -> list[float]:
    return [p.at]


component = Fault(
    name="actuator_stuck",
    title="Stuck actuator",
    path="actuator",
    parameters=ActuatorStuck,
    kernel=act,
    states=1,
    rest=rest,
    switches=switches,
)
