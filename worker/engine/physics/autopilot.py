"""Control loops of fixed-wing autopilots: references from a demand, PID loops with saturated outputs.

Srikanthakumar, equations 3.46 to 3.50; conditional integration (Astrom and Hagglund, Advanced PID Control (2006),
section 3.5): an integrator stops while its actuator is saturated in the direction of the error.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Order, Parameter, Signal
from worker.engine.kernels.maths import atan2, clip, kernel, norm2, wrap
from worker.engine.physics.aircraft import State
from worker.engine.physics.space import Vector, norm3

STILL = 1e-9
"""A horizontal demand smaller than this does not define a heading [N] or [m/s]."""

SIGNALS = (
    Signal("u_demand", "u_d", "m/s"),
    Signal("phi_demand", "φ_d", "rad"),
    Signal("theta_demand", "θ_d", "rad"),
    Signal("psi_demand", "ψ_d", "rad"),
)


class Loops(NamedTuple):
    """Gains of the elevator, aileron and throttle loops, and limits of the demand."""

    K_p1: Annotated[float, Parameter("", "Pitch loop, proportional gain", 0.0, 1e3)] = 0.35
    K_i1: Annotated[float, Parameter("1/s", "Pitch loop, integral gain", 0.0, 1e3)] = 0.2
    K_d1: Annotated[float, Parameter("s", "Pitch loop, gain of the pitch rate", 0.0, 1e3)] = 0.02
    K_p2: Annotated[float, Parameter("", "Roll loop, proportional gain", 0.0, 1e3)] = 0.8
    K_i2: Annotated[float, Parameter("1/s", "Roll loop, integral gain", 0.0, 1e3)] = 0.1
    K_d2: Annotated[float, Parameter("s", "Roll loop, gain of the roll rate", 0.0, 1e3)] = 0.1
    K_p4: Annotated[float, Parameter("s/m", "Speed loop, proportional gain", 0.0, 1e3)] = 0.1
    K_i4: Annotated[float, Parameter("1/m", "Speed loop, integral gain", 0.0, 1e3)] = 0.05
    k_u: Annotated[float, Parameter("m/(s N)", "Speed demanded per force", 0.0, 1e3)] = 0.2
    u_min: Annotated[float, Parameter("m/s", "Least speed demanded", 0.0, 1e3)] = 14.0
    u_max: Annotated[float, Parameter("m/s", "Greatest speed demanded", 0.0, 1e3)] = 20.0
    gamma_max: Annotated[float, Parameter("rad", "Steepest climb and descent demanded", 0.0, 1.5, symbol="γ_max")] = 0.3
    e_max: Annotated[float, Parameter("rad", "Largest heading error acted on", 1e-3, 3.2, symbol="e_ψ,max")] = 0.4
    stop: Annotated[float, Parameter("rad", "Largest deflection commanded", 1e-2, 1.5, symbol="δ_max")] = (
        0.4363323129985824
    )


ORDERS = (Order(("u_min",), ("u_max",), "lower u_min or raise u_max"),)


@kernel
def nan_guard(p: Any) -> float:
    """0, but NaN if a limit is NaN: every comparison with a NaN limit would pass."""
    return 0.0 * (p.u_min + p.u_max + p.gamma_max + p.e_max + p.stop)  # type: ignore[no-any-return]


@kernel
def referred(x: State, demand: Vector, per_demand: float, p: Any) -> Vector:
    """References from a demand: speed [m/s] and flight path angle [rad] within their limits, heading [rad]."""
    level = norm2(demand[0], demand[1])
    speed = clip(per_demand * norm3(demand), p.u_min, p.u_max)
    climb = clip(atan2(-demand[2], level), -p.gamma_max, p.gamma_max)
    return speed, climb, (x[5] if level < STILL else atan2(demand[1], demand[0]))


@kernel
def from_force(x: State, demand: Vector, p: Any) -> Vector:
    """References from a force [N]."""
    return referred(x, demand, p.k_u, p)


@kernel
def from_velocity(x: State, demand: Vector, p: Any) -> Vector:
    """References from a velocity [m/s]."""
    return referred(x, demand, 1.0, p)


@kernel
def turn(x: State, heading: float, p: Any) -> float:
    """The heading error, limited to e_max [rad]."""
    return clip(wrap(heading - x[5]), -p.e_max, p.e_max)


@kernel
def saturated(wanted: float, low: float, high: float, rate: float, push: float) -> tuple[float, float]:
    """A saturated command and the derivative of its integrator: 0 while `push` drives it further into saturation."""
    limited = clip(wanted, low, high)
    return limited, (0.0 if (wanted - limited) * push > 0.0 else rate)


@kernel
def elevator(x: State, theta: float, total: float, p: Any) -> tuple[float, float]:
    """Elevator [rad] and the derivative of its integrator; nose up is negative."""
    e = theta - x[4]
    return saturated(p.elevator - (p.K_p1 * e + p.K_i1 * total - p.K_d1 * x[10]), -p.stop, p.stop, e, -e)


@kernel
def aileron(x: State, phi: float, total: float, p: Any) -> tuple[float, float]:
    """Aileron [rad] and the derivative of its integrator; right roll is positive."""
    e = phi - x[3]
    return saturated(p.K_p2 * e + p.K_i2 * total - p.K_d2 * x[9], -p.stop, p.stop, e, e)


@kernel
def throttle(x: State, speed: float, total: float, p: Any) -> tuple[float, float]:
    """Throttle, 0 to 1, and the derivative of its integrator."""
    e = speed - x[6]
    return saturated(p.throttle + p.K_p4 * e + p.K_i4 * total, 0.0, 1.0, e, e)
