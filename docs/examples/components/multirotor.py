"""Multirotor: a point in space whose thrust vector follows a commanded acceleration with a lag.

    dq/dt = v        dv/dt = a - c (v - w)        da/dt = (u - a) / tau

q position [m], v velocity [m/s], a acceleration by the rotors beyond hovering [m/s2], u its command, w the wind; tau
the lag of attitude and thrust, c the drag per mass. Axes: x east, y north, z up.
Source: the outer loop of Mellinger and Kumar, Minimum snap trajectory generation and control for quadrotors (2011); the
attitude loop is a first-order lag here.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Derived, Limit, Parameter, Signal, Vehicle
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Errors, Surroundings
from worker.engine.physics.space import Vector, norm3

State = tuple[float, float, float, float, float, float, float, float, float]
FASTEST = 40.0


class Multirotor(NamedTuple):
    tau: Annotated[float, Parameter("s", "Lag of the acceleration", 0.02, 2.0, symbol="τ")] = 0.25
    c: Annotated[float, Parameter("1/s", "Drag per mass", 0.0, 5.0)] = 0.1


class Constants(NamedTuple):
    per_tau: float
    c: float


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "Start position, x", -1e6, 1e6)] = 0.0
    y: Annotated[float, Parameter("m", "Start position, y", -1e6, 1e6)] = 0.0
    z: Annotated[float, Parameter("m", "Start position, z", -1e6, 1e6)] = 0.0


@kernel
def derive(p: Multirotor, trim: object) -> tuple[float, float]:
    return 1.0 / p.tau, p.c


@kernel
def begin(start: Start, p: Constants) -> State:
    return start.x, start.y, start.z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@kernel
def derivative(t: float, x: State, u: Vector, env: Surroundings, p: Constants) -> State:
    _, _, _, vx, vy, vz, ax, ay, az = x
    return (
        vx, vy, vz,
        ax - p.c * (vx - env.wind_x), ay - p.c * (vy - env.wind_y), az - p.c * (vz - env.wind_z),
        (u[0] - ax) * p.per_tau, (u[1] - ay) * p.per_tau, (u[2] - az) * p.per_tau,
    )  # fmt: skip


@kernel
def position(x: State, p: Constants) -> Vector:
    return x[0], x[1], x[2]


@kernel
def velocity(x: State, p: Constants) -> Vector:
    return x[3], x[4], x[5]


@kernel
def pose(x: State, p: Constants) -> tuple[float, float, float, float, float, float]:
    return x[0], x[1], x[2], 0.0, 0.0, 0.0


@kernel
def outside(x: State, p: Constants) -> float:
    return 1.0 if norm3((x[3], x[4], x[5])) > FASTEST else 0.0


@kernel
def measured(x: State, e: Errors, p: Constants) -> State:
    return x[0] + e.x, x[1] + e.y, x[2] + e.z, x[3], x[4], x[5], x[6], x[7], x[8]


component = Vehicle(
    name="multirotor",
    title="Multirotor",
    dimension=3,
    parameters=Multirotor,
    start=Start,
    states=(
        *(Signal(a, a, "m") for a in ("x", "y", "z")),
        *(Signal(f"v{a}", f"v_{a}", "m/s") for a in ("x", "y", "z")),
        *(Signal(f"a{a}", f"a_{a}", "m/s2") for a in ("x", "y", "z")),
    ),
    inputs=tuple(Signal(f"acceleration_{a}", f"u_{a}", "m/s2") for a in ("x", "y", "z")),
    limits=(Limit(f"the speed exceeds {FASTEST:g} m/s"),),
    begin=begin,
    derivative=derivative,
    position=position,
    velocity=velocity,
    pose=pose,
    outside=outside,
    measured=measured,
    derived=Derived(Constants, derive),
)
