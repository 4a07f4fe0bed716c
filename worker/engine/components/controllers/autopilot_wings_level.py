"""Autopilot of a fixed-wing aircraft that turns with wings level, by the rudder.

    u_d = sat(k_u |F|) from a force F, sat(|V|) from a velocity V             phi_d = 0
    theta_d = alpha_trim + sat(atan2(-D_z, sqrt(D_x^2 + D_y^2)))              psi_d = atan2(D_y, D_x)

    elevator =  elevator_trim - (K_p1 e_theta + K_i1 int(e_theta) - K_d1 q)
    aileron  =   K_p2 e_phi + K_i2 int(e_phi) - K_d2 p
    rudder   = -(K_p3 e_psi + K_i3 int(e_psi) - K_d3 r)
    throttle =  throttle_trim + K_p4 e_u + K_i4 int(e_u)

D is the demand, F or V. u_d is limited to [u_min, u_max], the path angle within gamma_max, e_psi (wrapped) within
e_max, commands within their stops; an integrator is frozen while its command is at a stop and the error would drive it
further.
u is the forward speed through the air. Trim: level flight of the nominal aircraft at the nominal start speed.
Source: Srikanthakumar, equations 3.46 to 3.50, derivative terms as rate feedback. Reconstructed: all gains and
limits; pitch as a deviation from trim (without it the aircraft would fly a path angle of -alpha); signs by those of
C_mde and C_ndr; the limit on e_psi, without which heading steps above about 1 rad end in sideslip beyond 45 degrees.
It turns by sideslip (some 20 degrees of it): flyable in the model, poor practice.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Controller, Derived, Parameter, extended
from worker.engine.kernels.maths import kernel
from worker.engine.physics import autopilot
from worker.engine.physics.aerodynamics import Controls, Trimmed
from worker.engine.physics.aircraft import State
from worker.engine.physics.autopilot import Loops, aileron, elevator, nan_guard, saturated, throttle, turn
from worker.engine.physics.space import Vector


class Yaw(NamedTuple):
    K_p3: Annotated[float, Parameter("", "Yaw loop, proportional gain", 0.0, 1e3)] = 0.55
    K_i3: Annotated[float, Parameter("1/s", "Yaw loop, integral gain", 0.0, 1e3)] = 0.02
    K_d3: Annotated[float, Parameter("s", "Yaw loop, gain of the yaw rate", 0.0, 1e3)] = 0.24


WingsLevel = extended("WingsLevel", Loops, Yaw)
Constants = extended("Constants", WingsLevel, Trimmed)
Sums = tuple[float, float, float, float]
"""Integrals of the errors of pitch, roll, heading [rad s] and speed [m]."""


@kernel
def derive(p: Any, at: Trimmed) -> tuple[float, ...]:
    return *p[0:], at.alpha + nan_guard(p), at.elevator, at.throttle


@kernel
def prepare(x: State, wanted: Vector, p: Any) -> Sums:
    return 0.0, 0.0, 0.0, 0.0


@kernel
def command(t: float, x: State, c: Sums, wanted: Vector, p: Any) -> tuple[Controls, Sums]:
    speed, climb, heading = wanted
    e, de = elevator(x, p.alpha + climb, c[0], p)
    a, da = aileron(x, 0.0, c[1], p)
    error = turn(x, heading, p)
    r, dr = saturated(p.K_d3 * x[11] - p.K_p3 * error - p.K_i3 * c[2], -p.stop, p.stop, error, -error)
    power, dt = throttle(x, speed, c[3], p)
    return (e, a, r, power), (de, da, dr, dt)


@kernel
def references(x: State, wanted: Vector, p: Any) -> tuple[float, float, float, float]:
    return wanted[0], 0.0, p.alpha + wanted[1], wanted[2]


component = Controller(
    name="autopilot_wings_level",
    title="Autopilot, wings level",
    fits=("fixed_wing", "fixed_wing_linear"),
    parameters=WingsLevel,
    states=4,
    signals=autopilot.SIGNALS,
    prepare={"force": prepare, "velocity": prepare},
    command={"force": command, "velocity": command},
    references={"force": references, "velocity": references},
    translate={"force": autopilot.from_force, "velocity": autopilot.from_velocity},
    derived=Derived(Constants, derive),
    orders=autopilot.ORDERS,
)
