"""Pioneer 3-DX: a differential-drive robot behind its own wheel-speed controllers, with wheel slip and stops.

    dx/dt   = u cos(psi) - a omega sin(psi) - u_s sin(psi)
    dy/dt   = u sin(psi) + a omega cos(psi) + u_s cos(psi)
    dpsi/dt = omega
    du/dt     = (theta_3 omega^2 - theta_4 u + u_ref) / theta_1 + delta_u - g m/m_e (s + c sat(u / u_c))
    domega/dt = (-theta_5 u omega - theta_6 omega + omega_ref) / theta_2 + delta_w

x, y [m] is the point h, a distance a ahead of the wheels' axis; psi [rad], u [m/s], omega [rad/s]; u_ref [m/s] and
omega_ref [rad/s] go to the motors' PD controllers (3.17), which are part of the model:

    theta_1 = [R_a/k_a (m R_t r + 2 I_e) + 2 r k_DT] / (2 r k_PT)
    theta_2 = [R_a/k_a (I_e d^2 + 2 R_t r (I_z + m b^2)) + 2 r d k_DR] / (2 r d k_PR)
    theta_3 = R_a/k_a m b R_t / (2 k_PT)              theta_4 = R_a/k_a (k_a k_b/R_a + B_e) / (r k_PT) + 1
    theta_5 = R_a/k_a m b R_t / (d k_PR)              theta_6 = R_a/k_a (k_a k_b/R_a + B_e) d / (2 r k_PR) + 1

The speeds have stops: u stays within [u_min, u_max], omega within [-w_max, w_max]; at a stop any acceleration beyond it
is removed. They are the model's envelope: no state outside them can be reached.
Source: Srikanthakumar, equations 3.17 to 3.20 and table 3.1 (every default); model of De La Cruz and Carelli (2006).
Reconstructed: the input matrix of 3.18 with 1/theta_1 on the row of u and 1/theta_2 on the row of omega (printed as
one row); delta_u and delta_w as independent constants (3.20 is not evaluated, table 3.2 varies them directly).
Added: slope s of the ground along the heading and its rolling resistance c, as outside forces F_ex of 3.20 with the
effective mass m_e = m + 2 I_e/(R_t r) + 2 k_DT k_a/(R_a R_t); g = 9.81 m/s2. Below the creeping speed u_c = 1 cm/s
the resistance falls linearly to 0 at rest. A slope across the heading has no effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

from worker.engine.components.vehicles import unicycle
from worker.engine.components.vehicles.unicycle import GRAVITY, PER_CREEP, State
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Derived, Parameter, Signal, Trim, Vehicle, VehicleLook
from worker.engine.kernels.maths import clip, kernel, sincos
from worker.engine.kernels.views import Errors, Surroundings


class Pioneer(NamedTuple):
    m: Annotated[float, Parameter("kg", "Mass with payload", 1e-2, 1e4)] = 18.0
    I_z: Annotated[float, Parameter("kg m2", "Moment of inertia about the vertical axis", 1e-3, 1e4)] = 20.0
    R_t: Annotated[float, Parameter("m", "Radius of the tyre", 1e-3, 10.0)] = 0.14
    r: Annotated[float, Parameter("m", "Radius of the wheel", 1e-3, 10.0)] = 0.0977
    k_a: Annotated[float, Parameter("N m/A", "Torque constant times gear ratio", 1e-3, 1e3)] = 0.8808
    R_a: Annotated[float, Parameter("ohm", "Electric resistance", 1e-3, 1e3)] = 0.71
    I_e: Annotated[float, Parameter("kg m2", "Moment of inertia of rotor, gearbox and wheel", 0.0, 1e3)] = 2.0
    B_e: Annotated[float, Parameter("N m s", "Viscous friction of rotor, gearbox and wheel", 0.0, 1e3)] = 0.8
    k_b: Annotated[float, Parameter("V s/rad", "Voltage constant times gear ratio", 0.0, 1e3)] = 0.8808
    d: Annotated[float, Parameter("m", "Width between the wheels", 1e-2, 10.0)] = 0.395
    a: Annotated[float, Parameter("m", "Distance of the point h ahead of the axis", 0.0, 10.0)] = 0.25
    b: Annotated[float, Parameter("m", "Distance of the centre of mass ahead of the axis", -10.0, 10.0)] = 0.1
    k_PT: Annotated[float, Parameter("V s/m", "Motor control of u, proportional gain", 1e-2, 1e4)] = 11.0
    k_PR: Annotated[float, Parameter("V s/rad", "Motor control of the turn rate, proportional gain", 1e-2, 1e4)] = 11.0
    k_DT: Annotated[float, Parameter("V s2/m", "Motor control of u, derivative gain", 0.0, 1e3)] = 0.1
    k_DR: Annotated[float, Parameter("V s2/rad", "Motor control of the turn rate, derivative gain", 0.0, 1e3)] = 0.1
    u_s: Annotated[float, Parameter("m/s", "Lateral slip speed of the wheels", -10.0, 10.0)] = 0.05
    delta_u: Annotated[float, Parameter("m/s2", "Unmodelled acceleration along the heading", -50.0, 50.0, "δ_u")] = 0.2
    delta_w: Annotated[float, Parameter("rad/s2", "Unmodelled acceleration of the turn", -50.0, 50.0, "δ_ω")] = 0.5
    u_min: Annotated[float, Parameter("m/s", "Lower stop of u", -100.0, 0.0)] = 0.0
    u_max: Annotated[float, Parameter("m/s", "Upper stop of u", 1e-3, 100.0)] = 1.6
    w_max: Annotated[float, Parameter("rad/s", "Stop of the turn rate, either way", 1e-3, 100.0, "ω_max")] = 3.5


class Constants(NamedTuple):
    """du/dt = c_uww w^2 - c_u u + per_u u_ref + delta_u - fall (s + ...), domega/dt = -c_wuw u w - c_w w + per_w ..."""

    a: float
    u_s: float
    delta_u: float
    delta_w: float
    u_min: float
    u_max: float
    w_max: float
    per_u: float
    c_uww: float
    c_u: float
    per_w: float
    c_wuw: float
    c_w: float
    fall: float


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "Start position of h, x", -1e6, 1e6)] = 0.0
    y: Annotated[float, Parameter("m", "Start position of h, y", -1e6, 1e6)] = 0.0
    psi: Annotated[float, Parameter("rad", "Start heading, from the x axis", -6.4, 6.4, symbol="ψ")] = 0.0
    u: Annotated[float, Parameter("m/s", "Start speed", -100.0, 100.0)] = 0.0
    omega: Annotated[float, Parameter("rad/s", "Start turn rate", -100.0, 100.0, symbol="ω")] = 0.0


@kernel
def derive(p: Pioneer, trim: object) -> tuple[float, ...]:
    q = p.R_a / p.k_a
    friction = q * (p.k_a * p.k_b / p.R_a + p.B_e)
    theta_1 = (q * (p.m * p.R_t * p.r + 2.0 * p.I_e) + 2.0 * p.r * p.k_DT) / (2.0 * p.r * p.k_PT)
    inertia = p.I_e * p.d * p.d + 2.0 * p.R_t * p.r * (p.I_z + p.m * p.b * p.b)
    theta_2 = (q * inertia + 2.0 * p.r * p.d * p.k_DR) / (2.0 * p.r * p.d * p.k_PR)
    theta_3 = q * p.m * p.b * p.R_t / (2.0 * p.k_PT)
    theta_4 = friction / (p.r * p.k_PT) + 1.0
    theta_5 = q * p.m * p.b * p.R_t / (p.d * p.k_PR)
    theta_6 = friction * p.d / (2.0 * p.r * p.k_PR) + 1.0
    # comparisons would drop a NaN among the stops: 0 times them propagates it
    stops = 0.0 * (p.u_min + p.u_max + p.w_max)
    effective = p.m + 2.0 * p.I_e / (p.R_t * p.r) + 2.0 * p.k_DT / (q * p.R_t)
    return (
        p.a, p.u_s, p.delta_u, p.delta_w, p.u_min, p.u_max, p.w_max,
        1.0 / theta_1 + stops, theta_3 / theta_1, theta_4 / theta_1,
        1.0 / theta_2, theta_5 / theta_2, theta_6 / theta_2,
        GRAVITY * p.m / effective,
    )  # fmt: skip


def model(nominal: Mapping[str, float]) -> Constants:
    """The nominal robot, as a controller may model it."""
    parameters = Pioneer(*(nominal[f"vehicle.{field}"] for field in Pioneer._fields))
    return Constants(*plain(derive)(parameters, ()))


@kernel
def begin(start: Start, p: Constants) -> State:
    return start.x, start.y, start.psi, start.u, start.omega


@kernel
def derivative(t: float, x: State, u: tuple[float, float], env: Surroundings, p: Constants) -> State:
    s, c = sincos(x[2])
    speed = clip(x[3], p.u_min, p.u_max)
    turn = clip(x[4], -p.w_max, p.w_max)
    sideways = p.a * turn + p.u_s
    climb = env.slope_x * c + env.slope_y * s
    rolling = env.rolling * clip(speed * PER_CREEP, -1.0, 1.0)
    du = p.c_uww * turn * turn - p.c_u * speed + p.per_u * u[0] + p.delta_u - p.fall * (climb + rolling)
    dw = -p.c_wuw * speed * turn - p.c_w * turn + p.per_w * u[1] + p.delta_w
    held_u = ((speed >= p.u_max) & (du > 0.0)) | ((speed <= p.u_min) & (du < 0.0))
    held_w = ((turn >= p.w_max) & (dw > 0.0)) | ((turn <= -p.w_max) & (dw < 0.0))
    return (
        speed * c - sideways * s,
        speed * s + sideways * c,
        turn,
        0.0 if held_u else du,
        0.0 if held_w else dw,
    )


@kernel
def settle(x: State, p: Constants) -> State:
    # 0 times the speed prevents a non-finite value from becoming a stop
    u = clip(x[3], p.u_min, p.u_max) + 0.0 * x[3]
    w = clip(x[4], -p.w_max, p.w_max) + 0.0 * x[4]
    return x[0], x[1], x[2], u, w


@kernel
def velocity(x: State, p: Constants) -> tuple[float, float]:
    s, c = sincos(x[2])
    sideways = p.a * x[4] + p.u_s
    return x[3] * c - sideways * s, x[3] * s + sideways * c


@kernel
def outside(x: State, p: Constants) -> float:
    return 0.0


@kernel
def measured(x: State, e: Errors, p: Constants) -> State:
    # Within a step the integrator evaluates speeds beyond the stops, which the robot never reaches.
    u = clip(x[3], p.u_min, p.u_max)
    w = clip(x[4], -p.w_max, p.w_max)
    return x[0] + e.x, x[1] + e.y, x[2] + e.heading, u + e.speed, w


component = Vehicle(
    name="pioneer_3dx",
    title="Pioneer 3-DX",
    dimension=2,
    parameters=Pioneer,
    start=Start,
    states=(
        Signal("x", "x", "m"),
        Signal("y", "y", "m"),
        Signal("psi", "ψ", "rad"),
        Signal("u", "u", "m/s"),
        Signal("omega", "ω", "rad/s"),
    ),
    inputs=(Signal("u_ref", "u_ref", "m/s"), Signal("omega_ref", "ω_ref", "rad/s")),
    limits=(),
    begin=begin,
    derivative=derivative,
    position=unicycle.position,
    velocity=velocity,
    pose=unicycle.pose,
    outside=outside,
    measured=measured,
    settle=settle,
    derived=Derived(Constants, derive),
    trim=Trim(Constants, model),
    look=VehicleLook(mesh="two_wheels", heading="psi"),
)
