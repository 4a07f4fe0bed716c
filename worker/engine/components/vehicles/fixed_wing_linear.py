"""Fixed-wing aircraft, small disturbances about level flight at a reference speed; kinematics stay nonlinear.

    d(position)/dt = R (u, v, w)                         d(phi, theta, psi)/dt: Euler rates of (p, q, r)
    du/dt = X_u u' + X_w w' + X_q q + X_theta theta' + X_de de' + X_dt dt' - (omega x W)_x
    dw/dt = Z_u u' + Z_w w' + Z_q q + Z_theta theta' + Z_de de' + Z_dt dt' - (omega x W)_z
    dq/dt = M_u u' + M_w w' + M_q q +                   M_de de' + M_dt dt'
    dv/dt = Y_v v + Y_p p + Y_r r + Y_phi phi + Y_da da + Y_dr dr - (omega x W)_y
    dp/dt = L_v v + L_p p + L_r r +             L_da da + L_dr dr
    dr/dt = N_v v + N_p p + N_r r +             N_da da + N_dr dr

A prime is the difference from the trim at the reference speed; Z_q holds +u_0 and Y_r holds -u_0. The derivatives are
central differences of the nonlinear aircraft (same airframe, same coefficients) at that trim, at the nominal values.
Only these depend on the mass and coefficients of each evaluation:

    X_u, X_w, Z_u, Z_w, X_dt, Z_de, Y_v, Y_da, Y_dr in proportion to 1 / m;  X_dt to C_dt;  M_de to C_mde

All others keep their nominal values: making them uncertain has no effect. Weight does not change with the mass.
On the left u, v, w are over ground, on the right through the air. W is the wind and omega the turn rate, in body axes:
Z_q and Y_r turn the velocity through the air alone. Inputs are limited by the aircraft's stops. The flight starts level
at start.speed over ground, as the nonlinear aircraft is trimmed in still air at that speed, which need not be the
reference speed: what wind there is at t = 0 acts as a step gust.
Source: Srikanthakumar, equations 3.38, 3.39 and 3.44 and the text below it; coefficients as for the nonlinear one.
Limits: it underestimates the effect of the mass, and for large disturbances the effect may have the wrong sign: use it
only for comparison.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, NamedTuple

from worker.engine.components.vehicles import fixed_wing
from worker.engine.kernels.component import Derived, Parameter, Trim, extended
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Surroundings
from worker.engine.physics import trim
from worker.engine.physics.aerodynamics import Airframe, Controls, stopped
from worker.engine.physics.aircraft import State, kinematics, through_air, turned_wind
from worker.engine.physics.space import attitude


class Reference(NamedTuple):
    reference_speed: Annotated[
        float, Parameter("m/s", "Speed of the level flight about which it is linearised", 3.0, 100.0, symbol="V_0")
    ] = 20.0


FixedWingLinear = extended("FixedWingLinear", Airframe, Reference)


LONGITUDINAL, LATERAL = ("u", "w", "q", "theta", "de", "dt"), ("v", "p", "r", "phi", "da", "dr")
AXES = {"X": LONGITUDINAL, "Z": LONGITUDINAL, "M": LONGITUDINAL, "Y": LATERAL, "L": LATERAL, "N": LATERAL}
"""What the force along, or the moment about, each axis depends on."""
DERIVATIVES = [(axis, state) for axis, states in AXES.items() for state in states]

Trimmed = namedtuple(  # type: ignore[misc]
    "Trimmed",
    ["alpha", "elevator", "throttle", "m", "C_mde", "C_dt", "u_0", "w_0", "theta_0", "elevator_0", "throttle_0"]
    + [f"{axis}_{state}" for axis, state in DERIVATIVES],
)
"""Trim at the start speed, as of the nonlinear aircraft; trim and derivatives, such as X_u, at the reference speed."""


class Held(NamedTuple):
    stop: float


Constants = extended("Constants", Trimmed, Held)


def solve(values: Mapping[str, float]) -> Any:
    """Compute both trims and the derivatives at the nominal parameters; NoTrim if there is no trim at one of the
    speeds."""
    body, speed = trim.airframe(values), values["vehicle.reference_speed"]
    about = trim.trimmed(body, speed)
    u_0, _, w_0, *_ = trim.level(speed, *about)
    table = trim.derivatives(body, speed, about)
    entries = [float(table["XYZLMN".index(axis), trim.STATES.index(state)]) for axis, state in DERIVATIVES]
    start = trim.trimmed(body, values["start.speed"])
    return Trimmed._make((*start, body.m, body.C_mde, body.C_dt, u_0, w_0, *about, *entries))


@kernel
def derive(p: Any, at: Any) -> tuple[float, ...]:
    lighter = at.m / p.m
    return (
        *at[0:11],
        at.X_u * lighter,
        at.X_w * lighter,
        at.X_q,
        at.X_theta,
        at.X_de,
        at.X_dt * lighter * p.C_dt / at.C_dt,
        at.Z_u * lighter,
        at.Z_w * lighter,
        at.Z_q,
        at.Z_theta,
        at.Z_de * lighter,
        at.Z_dt,
        at.M_u,
        at.M_w,
        at.M_q,
        at.M_theta,
        at.M_de * p.C_mde / at.C_mde,
        at.M_dt,
        at.Y_v * lighter,
        at.Y_p,
        at.Y_r,
        at.Y_phi,
        at.Y_da * lighter,
        at.Y_dr * lighter,
        *at[35:47],
        p.stop,
    )


@kernel
def derivative(t: float, x: State, u: Controls, env: Surroundings, p: Any) -> State:
    a = attitude(x[3], x[4], x[5])
    motion, turning = kinematics(x, a)
    air = through_air(x, a, env)
    wind = turned_wind(x, a, env)
    inputs = stopped(u, p.stop)
    de = inputs[0] - p.elevator_0
    dt = inputs[3] - p.throttle_0
    da = inputs[1]
    dr = inputs[2]
    u_p = air[0] - p.u_0
    w_p = air[2] - p.w_0
    theta = x[4] - p.theta_0
    v, phi, roll, q, yaw = air[1], x[3], x[9], x[10], x[11]
    linear = (
        p.X_u * u_p + p.X_w * w_p + p.X_q * q + p.X_theta * theta + p.X_de * de + p.X_dt * dt + wind[0],
        p.Y_v * v + p.Y_p * roll + p.Y_r * yaw + p.Y_phi * phi + p.Y_da * da + p.Y_dr * dr + wind[1],
        p.Z_u * u_p + p.Z_w * w_p + p.Z_q * q + p.Z_theta * theta + p.Z_de * de + p.Z_dt * dt + wind[2],
    )
    angular = (
        p.L_v * v + p.L_p * roll + p.L_r * yaw + p.L_da * da + p.L_dr * dr,
        p.M_u * u_p + p.M_w * w_p + p.M_q * q + p.M_de * de + p.M_dt * dt,
        p.N_v * v + p.N_p * roll + p.N_r * yaw + p.N_da * da + p.N_dr * dr,
    )
    return *motion, *turning, *linear, *angular


component = replace(
    fixed_wing.component,
    name="fixed_wing_linear",
    title="Fixed-wing aircraft, linear",
    parameters=FixedWingLinear,
    derivative=derivative,
    derived=Derived(Constants, derive),
    trim=Trim(Trimmed, solve),
)
