"""Fixed-wing aircraft in six degrees of freedom: a small electric aeroplane, Ultra Stick 25e.

    d(position)/dt = R (u, v, w)                              d(phi, theta, psi)/dt: Euler rates of (p, q, r)
    du/dt = r v - q w - g sin(theta) + (X + T) / m            T = C_dt throttle, z_p below the centre of gravity
    dv/dt = p w - r u + g cos(theta) sin(phi) + Y / m
    dw/dt = q u - p v + g cos(theta) cos(phi) + Z / m
    I_xx dp/dt - I_xz dr/dt = L - (I_zz - I_yy) q r + I_xz p q
    I_yy dq/dt              = M - (I_xx - I_zz) p r - I_xz (p^2 - r^2) + I_p omega_p r
    I_zz dr/dt - I_xz dp/dt = N - (I_yy - I_xx) p q - I_xz q r - I_p omega_p q

    X, Y, Z: lift, drag, side force turned by angle of attack alpha and sideslip beta; Q = rho V^2 / 2
    lift = Q S (C_L0 + C_La alpha + C_Lq q c / 2V + C_Lde de)
    drag = Q S (C_D0 + (C_L - C_LD)^2 / (pi e b^2 / S) + C_Dde |de| + C_Dda |da| + C_Ddr |dr|)
    side = Q S (C_Yb beta + C_Yp p b / 2V + C_Yr r b / 2V + C_Ydr dr)
    L = Q S b (C_lb beta + C_lp p b / 2V + C_lr r b / 2V + C_lda da + C_ldr dr)
    M = Q S c (C_m0 + C_ma alpha + C_mq q c / 2V + C_mde de) - x_a Z + z_p T
    N = Q S b (C_nb beta + C_np p b / 2V + C_nr r b / 2V + C_nda da + C_ndr dr) + x_a Y

World axes north, east, down; body axes forward, right, down. u, v, w are over ground; V, alpha and beta are through the
air: wind enters there and affects what the controller measures. Inputs are limited by the aircraft's own stops. The
flight starts level at start.speed over ground, as it is trimmed in still air at that speed and the nominal parameters:
what wind there is at t = 0 acts as a step gust.

Source: Srikanthakumar, 3.38 to 3.43. Gravity in dv/dt and dw/dt has the sign for z down (printed: the
opposite, with which no level flight exists); the propeller's signs are as printed. Source of the coefficients:
University of Minnesota, UAV Research Group, Ultrastick_config.m (revision 765, 2012), the same as
ParamDef_UltraStick25e_Old.m of UASLab/OpenFlight; mass and moments of inertia of its aircraft Loki; positive aileron
rolls right. C_mde and C_dt: Srikanthakumar, section 3.4.4 (C_dt read as the thrust at full throttle in newton).
Reconstructed: which airframe it was. Limits: no stall, no servo lag, thrust independent of airspeed, lift without
the term of d(alpha)/dt, linear side force and yaw moment also at large sideslip.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from worker.engine.kernels.component import Derived, Order, Trim, Vehicle, VehicleLook, extended
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings
from worker.engine.physics import aircraft, trim
from worker.engine.physics.aerodynamics import (
    Airframe,
    Constants,
    Controls,
    Trimmed,
    accelerations,
    constants,
    stopped,
)
from worker.engine.physics.aircraft import Start, State, kinematics, level, through_air
from worker.engine.physics.space import attitude

FixedWing = extended("FixedWing", Constants, Trimmed)


def solve(values: Mapping[str, float]) -> Trimmed:
    """Trim at the nominal parameters and start speed; NoTrim if there is none."""
    return trim.trimmed(trim.airframe(values), values["start.speed"])


@kernel
def derive(p: Airframe, at: Trimmed) -> tuple[float, ...]:
    return *constants(p), *at[0:]


@kernel
def begin(start: Start, p: Any) -> State:
    return level(start, p.alpha)


@kernel
def derivative(t: float, x: State, u: Controls, env: Surroundings, p: Any) -> State:
    a = attitude(x[3], x[4], x[5])
    motion, turning = kinematics(x, a)
    air = through_air(x, a, env)
    linear, angular = accelerations(a, (x[6], x[7], x[8]), air, (x[9], x[10], x[11]), stopped(u, p.stop), p)
    return *motion, *turning, *linear, *angular


component = Vehicle(
    name="fixed_wing",
    title="Fixed-wing aircraft, six degrees of freedom",
    dimension=3,
    parameters=Airframe,
    start=Start,
    states=aircraft.STATES,
    inputs=aircraft.INPUTS,
    limits=aircraft.LIMITS,
    begin=begin,
    derivative=derivative,
    position=aircraft.position,
    velocity=aircraft.velocity,
    pose=aircraft.pose,
    outside=aircraft.outside,
    measured=aircraft.measured,
    felt=aircraft.felt,
    derived=Derived(FixedWing, derive),
    orders=(Order(("I_xz", "I_xz"), ("I_xx", "I_zz"), "no body has such inertia; give I_xz closer to 0", equal=False),),
    trim=Trim(Trimmed, solve),
    frame="ned",
    look=VehicleLook(mesh="aircraft", heading="psi"),
)
