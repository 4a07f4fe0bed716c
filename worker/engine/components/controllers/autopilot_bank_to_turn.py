"""Autopilot of a fixed-wing aircraft that banks to turn, with the rudder co-ordinating.

    u_d = sat(k_u |F|) from a force F, sat(|V|) from a velocity V             phi_d = sat(k_phi e_psi)
    theta_d = alpha_trim + sat(atan2(-D_z, sqrt(D_x^2 + D_y^2)))              psi_d = atan2(D_y, D_x)

    elevator =  elevator_trim - (K_p1 e_theta + K_i1 int(e_theta) - K_d1 q)
    aileron  =   K_p2 e_phi + K_i2 int(e_phi) - K_d2 p
    rudder   =   K_d3 (r - g sin(phi) cos(theta) / V)
    throttle =  throttle_trim + K_p4 e_u + K_i4 int(e_u)

D is the demand, F or V. u_d is limited to [u_min, u_max], the path angle within gamma_max, e_psi (wrapped) within
e_max, phi_d within phi_max, commands within their stops; an integrator is frozen while its command is at a stop and the
error would drive it further. u, V: forward speed and speed through the air. The rudder damps deviations from the yaw
rate of a co-ordinated turn. Trim: level flight of the nominal aircraft at the nominal start speed.
Source: Srikanthakumar, equations 3.46 to 3.50, with roll and yaw as aircraft are flown (Beard and McLain, Small
Unmanned Aircraft (2012), section 6.1). Gains and limits are chosen, not published.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Controller, Derived, Parameter, extended
from worker.engine.kernels.maths import clip, kernel, sincos
from worker.engine.physics import autopilot
from worker.engine.physics.aerodynamics import Controls, Trimmed
from worker.engine.physics.aircraft import State
from worker.engine.physics.autopilot import Loops, aileron, elevator, nan_guard, throttle, turn
from worker.engine.physics.space import Vector, norm3


class Turn(NamedTuple):
    K_d3: Annotated[float, Parameter("s", "Rudder per yaw rate beyond the turn's", 0.0, 1e3)] = 0.24
    k_phi: Annotated[float, Parameter("", "Bank demanded per heading error", 0.0, 1e2, symbol="k_φ")] = 1.2
    phi_max: Annotated[float, Parameter("rad", "Largest bank demanded", 0.0, 1.5, symbol="φ_max")] = 0.6
    g: Annotated[float, Parameter("m/s2", "Gravity", 9.0, 10.0)] = 9.81


BankToTurn = extended("BankToTurn", Loops, Turn)
Constants = extended("Constants", BankToTurn, Trimmed)
Sums = tuple[float, float, float]
"""Integrals of the errors of pitch, roll [rad s] and speed [m]."""


@kernel
def derive(p: Any, at: Trimmed) -> tuple[float, ...]:
    return *p[0:], at.alpha + nan_guard(p) + 0.0 * p.phi_max, at.elevator, at.throttle


@kernel
def prepare(x: State, wanted: Vector, p: Any) -> Sums:
    return 0.0, 0.0, 0.0


@kernel
def bank(error: float, p: Any) -> float:
    return clip(p.k_phi * error, -p.phi_max, p.phi_max)


@kernel
def command(t: float, x: State, c: Sums, wanted: Vector, p: Any) -> tuple[Controls, Sums]:
    speed, climb, heading = wanted
    e, de = elevator(x, p.alpha + climb, c[0], p)
    a, da = aileron(x, bank(turn(x, heading, p), p), c[1], p)
    s_phi, _ = sincos(x[3])
    _, c_theta = sincos(x[4])
    level = p.g * s_phi * c_theta / norm3((x[6], x[7], x[8]))
    power, dt = throttle(x, speed, c[2], p)
    return (e, a, clip(p.K_d3 * (x[11] - level), -p.stop, p.stop), power), (de, da, dt)


@kernel
def references(x: State, wanted: Vector, p: Any) -> tuple[float, float, float, float]:
    return wanted[0], bank(turn(x, wanted[2], p), p), p.alpha + wanted[1], wanted[2]


component = Controller(
    name="autopilot_bank_to_turn",
    title="Autopilot, bank to turn",
    fits=("fixed_wing", "fixed_wing_linear"),
    parameters=BankToTurn,
    states=3,
    signals=autopilot.SIGNALS,
    prepare={"force": prepare, "velocity": prepare},
    command={"force": command, "velocity": command},
    references={"force": references, "velocity": references},
    translate={"force": autopilot.from_force, "velocity": autopilot.from_velocity},
    derived=Derived(Constants, derive),
    orders=autopilot.ORDERS,
)
