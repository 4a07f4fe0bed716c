"""Velocity control of a multirotor, towards a demanded force or velocity.

    u = sat(k_v (v_d - v))        from a force D: v_d = sat(k_f D)        from a velocity D: v_d = sat(D)

sat limits the length of the vector: |v_d| <= v_max, |u| <= u_max.
Source: Mellinger and Kumar, Minimum snap trajectory generation and control for quadrotors (2011), the outer loop.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Controller, Parameter, Signal
from worker.engine.kernels.maths import kernel
from worker.engine.physics.space import Vector, norm3

State = tuple[float, float, float, float, float, float, float, float, float]


class MultirotorVelocity(NamedTuple):
    k_f: Annotated[float, Parameter("m/(s N)", "Speed demanded per force", 0.0, 1e3)] = 0.2
    k_v: Annotated[float, Parameter("1/s", "Acceleration per velocity error", 0.0, 1e2)] = 1.5
    v_max: Annotated[float, Parameter("m/s", "Largest speed demanded", 0.1, 40.0)] = 8.0
    u_max: Annotated[float, Parameter("m/s2", "Largest acceleration commanded", 0.1, 50.0)] = 5.0


@kernel
def limited(v: Vector, longest: float) -> Vector:
    length = norm3(v)
    factor = longest / length if length > longest else 1.0
    return factor * v[0], factor * v[1], factor * v[2]


@kernel
def follow_force(x: State, demand: Vector, p: MultirotorVelocity) -> Vector:
    return limited((p.k_f * demand[0], p.k_f * demand[1], p.k_f * demand[2]), p.v_max)


@kernel
def follow_velocity(x: State, demand: Vector, p: MultirotorVelocity) -> Vector:
    return limited(demand, p.v_max)


@kernel
def accelerated(x: State, aim: Vector, p: MultirotorVelocity) -> Vector:
    return limited((p.k_v * (aim[0] - x[3]), p.k_v * (aim[1] - x[4]), p.k_v * (aim[2] - x[5])), p.u_max)


@kernel
def prepare(x: State, demand: Vector, p: MultirotorVelocity) -> tuple[()]:
    return ()


@kernel
def command_force(t: float, x: State, c: tuple[()], demand: Vector, p: MultirotorVelocity) -> tuple[Vector, tuple[()]]:
    return accelerated(x, follow_force(x, demand, p), p), ()


@kernel
def command_velocity(
    t: float, x: State, c: tuple[()], demand: Vector, p: MultirotorVelocity
) -> tuple[Vector, tuple[()]]:
    return accelerated(x, follow_velocity(x, demand, p), p), ()


component = Controller(
    name="multirotor_velocity",
    title="Velocity control of a multirotor",
    fits=("multirotor",),
    parameters=MultirotorVelocity,
    states=0,
    signals=tuple(Signal(f"v{a}_demand", f"v_{a},d", "m/s") for a in ("x", "y", "z")),
    prepare={"force": prepare, "velocity": prepare},
    command={"force": command_force, "velocity": command_velocity},
    references={"force": follow_force, "velocity": follow_velocity},
)
