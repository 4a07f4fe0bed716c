"""My controller: PI control of speed and turn rate, towards a demanded force or velocity.

    F = K_p (v_d - v) + K_i int(v_d - v)        tau = K_w (omega_d - omega)
    from a force D:     v_d = k_f D . heading,  omega_d = k_theta angle(D, heading)
    from a velocity D:  v_d =     D . heading,  omega_d = k_theta angle(D, heading)

angle is wrapped to (-pi, pi].
Source: any textbook on PID control; replace this line by your own source. This text is the help page of the component.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Controller, Parameter, Signal
from worker.engine.kernels.maths import atan2, kernel, sincos

State = tuple[float, float, float, float, float]
Pair = tuple[float, float]


class MyController(NamedTuple):
    k_f: Annotated[float, Parameter("m/(s N)", "Speed demanded per force", 0.0, 1e3)] = 0.06
    k_theta: Annotated[float, Parameter("1/s", "Turn rate demanded per heading error", 0.0, 1e3, symbol="k_θ")] = 4.0
    K_p: Annotated[float, Parameter("N s/m", "Speed loop, proportional gain", 0.0, 1e5)] = 8.0
    K_i: Annotated[float, Parameter("N/m", "Speed loop, integral gain", 0.0, 1e5)] = 0.5
    K_w: Annotated[float, Parameter("N m s/rad", "Turn loop, proportional gain", 0.0, 1e5)] = 2.0


@kernel
def follow_force(x: State, demand: Pair, p: MyController) -> Pair:
    # The references: speed and turn rate. x is the vehicle's state as measured, in the order of its `states`.
    s, c = sincos(x[2])
    along, across = demand[0] * c + demand[1] * s, demand[1] * c - demand[0] * s
    return p.k_f * along, p.k_theta * atan2(across, along)


@kernel
def follow_velocity(x: State, demand: Pair, p: MyController) -> Pair:
    s, c = sincos(x[2])
    along, across = demand[0] * c + demand[1] * s, demand[1] * c - demand[0] * s
    return along, p.k_theta * atan2(across, along)


@kernel
def prepare(x: State, demand: Pair, p: MyController) -> tuple[float]:
    # The controller's own state at the start: one integral, so states=1 below.
    return (0.0,)


@kernel
def control(x: State, c: tuple[float], aim: Pair, p: MyController) -> tuple[Pair, tuple[float]]:
    # The vehicle's inputs in the order of its `inputs`, and the rate of the controller's own state.
    error = aim[0] - x[3]
    return (p.K_p * error + p.K_i * c[0], p.K_w * (aim[1] - x[4])), (error,)


@kernel
def command_force(t: float, x: State, c: tuple[float], demand: Pair, p: MyController) -> tuple[Pair, tuple[float]]:
    return control(x, c, follow_force(x, demand, p), p)


@kernel
def command_velocity(t: float, x: State, c: tuple[float], demand: Pair, p: MyController) -> tuple[Pair, tuple[float]]:
    return control(x, c, follow_velocity(x, demand, p), p)


component = Controller(
    name="my_controller",
    title="My controller",
    fits=("unicycle",),  # the vehicles whose states and inputs are in the order that the kernels above assume
    parameters=MyController,
    states=1,
    signals=(Signal("v_demand", "v_d", "m/s"), Signal("omega_demand", "ω_d", "rad/s")),
    prepare={"force": prepare, "velocity": prepare},
    command={"force": command_force, "velocity": command_velocity},
    references={"force": follow_force, "velocity": follow_velocity},
)
