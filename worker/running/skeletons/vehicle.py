"""My vehicle: a ground robot with a heading, driven by a force and a torque, slowed by drag.

    dx/dt = v cos(theta)        dv/dt = (F - c v) / m
    dy/dt = v sin(theta)        domega/dt = (tau - c_r omega) / J
    dtheta/dt = omega

x, y [m], theta [rad], v [m/s], omega [rad/s]; F [N], tau [N m]; m mass, J moment of inertia, c and c_r drag.
Source: Newton's second law; replace this line by your own source, and the text above by your own equations: this text
is the help page of the component.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Limit, Parameter, Signal, Vehicle, VehicleLook
from worker.engine.kernels.maths import kernel, sincos
from worker.engine.kernels.views import Errors, Surroundings

FASTEST = 50.0  # a constant: kernels may read numbers and tuples that are assigned once


class MyVehicle(NamedTuple):
    # A parameter: unit, text, lower and upper limit; with a default. Every one can be made uncertain in a campaign.
    m: Annotated[float, Parameter("kg", "Mass", 0.1, 1e4)] = 5.0
    J: Annotated[float, Parameter("kg m2", "Moment of inertia about the vertical axis", 1e-4, 1e4)] = 0.1
    drag: Annotated[float, Parameter("N s/m", "Drag per speed", 0.0, 1e3, symbol="c")] = 0.5
    turn_drag: Annotated[float, Parameter("N m s/rad", "Drag per turn rate", 0.0, 1e3, symbol="c_r")] = 0.01


class Constants(NamedTuple):
    # What `derive` computes once for each simulation; the kernels receive it in place of the parameters.
    per_m: float
    per_J: float
    drag: float
    turn_drag: float


class Start(NamedTuple):
    # The state at the start, as a campaign gives it under `start`.
    x: Annotated[float, Parameter("m", "Start position, x", -1e6, 1e6)] = 0.0
    y: Annotated[float, Parameter("m", "Start position, y", -1e6, 1e6)] = 0.0
    theta: Annotated[float, Parameter("rad", "Start heading, from the x axis", -6.4, 6.4, symbol="θ")] = 0.0
    v: Annotated[float, Parameter("m/s", "Start speed", -50.0, 50.0)] = 0.0
    omega: Annotated[float, Parameter("rad/s", "Start turn rate", -50.0, 50.0, symbol="ω")] = 0.0


State = tuple[float, float, float, float, float]


@kernel
def derive(p: MyVehicle, trim: object) -> tuple[float, ...]:
    return 1.0 / p.m, 1.0 / p.J, p.drag, p.turn_drag


@kernel
def begin(start: Start, p: Constants) -> State:
    return start.x, start.y, start.theta, start.v, start.omega


@kernel
def derivative(t: float, x: State, u: tuple[float, float], env: Surroundings, p: Constants) -> State:
    # The rates of the states, in their order. x: the state; u: the inputs; env: wind and ground.
    _, _, theta, v, omega = x
    s, c = sincos(theta)  # the functions of worker.engine.kernels.maths are fast; those of math work too
    return v * c, v * s, omega, (u[0] - p.drag * v) * p.per_m, (u[1] - p.turn_drag * omega) * p.per_J


@kernel
def position(x: State, p: Constants) -> tuple[float, float]:
    return x[0], x[1]


@kernel
def velocity(x: State, p: Constants) -> tuple[float, float]:
    s, c = sincos(x[2])
    return x[3] * c, x[3] * s


@kernel
def pose(x: State, p: Constants) -> tuple[float, float, float, float, float, float]:
    # How it is drawn: x, y, z, roll, pitch, yaw.
    return x[0], x[1], 0.0, 0.0, 0.0, x[2]


@kernel
def outside(x: State, p: Constants) -> float:
    # 0.0 while the model holds, else the number of the exceeded limit in `limits`, counted from 1.0.
    return 1.0 if abs(x[3]) > FASTEST else 0.0


@kernel
def measured(x: State, e: Errors, p: Constants) -> State:
    # The state as navigation reports it: faults of navigation are in e.
    return x[0] + e.x, x[1] + e.y, x[2] + e.heading, x[3] + e.speed, x[4]


component = Vehicle(
    name="my_vehicle",
    title="My vehicle",
    dimension=2,
    parameters=MyVehicle,
    start=Start,
    states=(
        Signal("x", "x", "m"),
        Signal("y", "y", "m"),
        Signal("theta", "θ", "rad"),
        Signal("v", "v", "m/s"),
        Signal("omega", "ω", "rad/s"),
    ),
    inputs=(Signal("force", "F", "N"), Signal("torque", "τ", "N m")),
    limits=(Limit(f"the speed exceeds {FASTEST:g} m/s"),),
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
