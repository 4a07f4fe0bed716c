"""Unicycle: a point with a heading, driven by a force along it and a torque about it.

    dx/dt = v cos(theta)        dv/dt = F / m - g (s + c sat(v / v_c))
    dy/dt = v sin(theta)        domega/dt = tau / J
    dtheta/dt = omega

x, y [m], theta [rad], v [m/s], omega [rad/s]; F [N], tau [N m]; m mass, J moment of inertia;
g = 9.81 m/s2, s the slope of the ground along the heading (0 on level ground), c its rolling resistance (0 on none),
which below the creeping speed v_c = 1 cm/s falls linearly to 0 at rest.
Source: Srikanthakumar, Optimisation-Based Verification Process of Obstacle Avoidance Systems for Unmanned Vehicles,
equations 3.1 (kinematics) and 3.2 (dynamics). No wheel slip, no actuator limits; slope and
rolling resistance are added.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Limit, Parameter, Signal, Vehicle, VehicleLook
from worker.engine.kernels.maths import clip, kernel, sincos
from worker.engine.kernels.views import Errors, Surroundings


class Unicycle(NamedTuple):
    m: Annotated[float, Parameter("kg", "Mass", 1e-3, 1e5)] = 5.0
    J: Annotated[float, Parameter("kg m2", "Moment of inertia about the vertical axis", 1e-6, 1e5)] = 0.05


class Constants(NamedTuple):
    per_m: float
    per_J: float


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "Start position, x", -1e6, 1e6)] = 0.0
    y: Annotated[float, Parameter("m", "Start position, y", -1e6, 1e6)] = 0.0
    theta: Annotated[float, Parameter("rad", "Start heading, from the x axis", -6.4, 6.4, symbol="θ")] = 0.0
    v: Annotated[float, Parameter("m/s", "Start speed", -100.0, 100.0)] = 0.0
    omega: Annotated[float, Parameter("rad/s", "Start turn rate", -100.0, 100.0, symbol="ω")] = 0.0


FASTEST_TURN = 1e3
GRAVITY = 9.81
PER_CREEP = 100.0
FASTEST = 1e3
State = tuple[float, float, float, float, float]


@kernel
def derive(p: Unicycle, trim: tuple[()]) -> tuple[float, float]:
    return 1.0 / p.m, 1.0 / p.J


@kernel
def begin(start: Start, p: Constants) -> State:
    return start.x, start.y, start.theta, start.v, start.omega


@kernel
def derivative(t: float, x: State, u: tuple[float, float], env: Surroundings, p: Constants) -> State:
    _, _, theta, v, omega = x
    s, c = sincos(theta)
    climb = env.slope_x * c + env.slope_y * s
    rolling = env.rolling * clip(v * PER_CREEP, -1.0, 1.0)
    return v * c, v * s, omega, u[0] * p.per_m - GRAVITY * (climb + rolling), u[1] * p.per_J


@kernel
def position(x: State, p: Constants) -> tuple[float, float]:
    return x[0], x[1]


@kernel
def velocity(x: State, p: Constants) -> tuple[float, float]:
    s, c = sincos(x[2])
    return x[3] * c, x[3] * s


@kernel
def pose(x: State, p: Constants) -> tuple[float, float, float, float, float, float]:
    return x[0], x[1], 0.0, 0.0, 0.0, x[2]


@kernel
def outside(x: State, p: Constants) -> float:
    code = 1.0 if abs(x[3]) > FASTEST else 0.0
    return 2.0 if abs(x[4]) > FASTEST_TURN else code


@kernel
def measured(x: State, e: Errors, p: Constants) -> State:
    return x[0] + e.x, x[1] + e.y, x[2] + e.heading, x[3] + e.speed, x[4]


component = Vehicle(
    name="unicycle",
    title="Unicycle",
    dimension=2,
    parameters=Unicycle,
    start=Start,
    states=(
        Signal("x", "x", "m"),
        Signal("y", "y", "m"),
        Signal("theta", "θ", "rad"),
        Signal("v", "v", "m/s"),
        Signal("omega", "ω", "rad/s"),
    ),
    inputs=(Signal("force", "F", "N"), Signal("torque", "τ", "N m")),
    limits=(
        Limit(f"the speed exceeds {FASTEST:g} m/s"),
        Limit(f"the turn rate exceeds {FASTEST_TURN:g} rad/s"),
    ),
    begin=begin,
    derivative=derivative,
    position=position,
    velocity=velocity,
    pose=pose,
    outside=outside,
    measured=measured,
    derived=Derived(Constants, derive),
    look=VehicleLook(mesh="robot", heading="theta"),
)
