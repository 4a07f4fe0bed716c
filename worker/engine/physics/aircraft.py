"""The common part of aircraft models with Euler angles: 12 states, kinematics, start, envelope, navigation, air data.

Srikanthakumar, equations 3.38 and 3.39. World axes north, east, down; body axes forward, right, down.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Limit, Parameter, Signal
from worker.engine.kernels.maths import kernel, sincos
from worker.engine.kernels.views import Errors, Surroundings
from worker.engine.physics.space import Attitude, Vector, attitude, euler_rates, to_body, to_world

State = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""x, y, z [m]; phi, theta, psi [rad]; u, v, w over ground [m/s]; p, q, r [rad/s]."""

STATES = (
    Signal("x", "x", "m"),
    Signal("y", "y", "m"),
    Signal("z", "z", "m"),
    Signal("phi", "φ", "rad"),
    Signal("theta", "θ", "rad"),
    Signal("psi", "ψ", "rad"),
    Signal("u", "u", "m/s"),
    Signal("v", "v", "m/s"),
    Signal("w", "w", "m/s"),
    Signal("p", "p", "rad/s"),
    Signal("q", "q", "rad/s"),
    Signal("r", "r", "rad/s"),
)
INPUTS = (
    Signal("elevator", "δ_e", "rad"),
    Signal("aileron", "δ_a", "rad"),
    Signal("rudder", "δ_r", "rad"),
    Signal("throttle", "δ_τ", ""),
)

STEEPEST = 1.4
LARGEST_BANK = 2.0
SLOWEST = 3.0
FASTEST = 100.0
FASTEST_TURN = 50.0
LIMITS = (
    Limit(f"the pitch exceeds {STEEPEST:g} rad"),
    Limit(f"the bank exceeds {LARGEST_BANK:g} rad"),
    Limit(f"the forward speed through the air is below {SLOWEST:g} m/s"),
    Limit("the sideways speed through the air exceeds the forward speed"),
    Limit("the angle of attack through the air exceeds 45 degrees"),
    Limit(f"the forward speed through the air exceeds {FASTEST:g} m/s"),
    Limit(f"the magnitudes of the turn rates p, q, r add up to more than {FASTEST_TURN:g} rad/s"),
)


class Start(NamedTuple):
    """Level flight on a heading, trimmed in still air: what wind there is at t = 0 acts as a step gust."""

    x: Annotated[float, Parameter("m", "Start position, north", -1e6, 1e6)] = 0.0
    y: Annotated[float, Parameter("m", "Start position, east", -1e6, 1e6)] = 0.0
    z: Annotated[float, Parameter("m", "Start position, down", -1e6, 1e6)] = 0.0
    psi: Annotated[float, Parameter("rad", "Start heading, from north over east", -6.4, 6.4, symbol="ψ")] = 0.0
    speed: Annotated[
        float, Parameter("m/s", "Start speed over ground, trimmed in still air", 3.0, 100.0, symbol="V")
    ] = 20.0


@kernel
def level(start: Start, alpha: float) -> State:
    """Straight level flight at an angle of attack."""
    s, c = sincos(alpha)
    return (
        start.x,
        start.y,
        start.z,
        0.0,
        alpha,
        start.psi,
        start.speed * c,
        0.0,
        start.speed * s,
        0.0,
        0.0,
        0.0,
    )


@kernel
def kinematics(x: State, a: Attitude) -> tuple[Vector, Vector]:
    """Derivatives of position [m/s] and Euler angles [rad/s]."""
    return to_world(a, (x[6], x[7], x[8])), euler_rates(a, (x[9], x[10], x[11]))


@kernel
def through_air(x: State, a: Attitude, env: Surroundings) -> Vector:
    """Velocity through the air in body axes [m/s]."""
    wind = to_body(a, (env.wind_x, env.wind_y, env.wind_z))
    # without an environment the wind is a constant 0, so the compiler drops the transformation above
    calm = (env.wind_x == 0.0) & (env.wind_y == 0.0) & (env.wind_z == 0.0)
    return (
        x[6] - (0.0 if calm else wind[0]),
        x[7] - (0.0 if calm else wind[1]),
        x[8] - (0.0 if calm else wind[2]),
    )


@kernel
def turned_wind(x: State, a: Attitude, env: Surroundings) -> Vector:
    """-omega x W: how fast the wind W changes in the body's axes because these turn [m/s2]."""
    wind = to_body(a, (env.wind_x, env.wind_y, env.wind_z))
    calm = (env.wind_x == 0.0) & (env.wind_y == 0.0) & (env.wind_z == 0.0)  # as above
    return (
        0.0 if calm else x[11] * wind[1] - x[10] * wind[2],
        0.0 if calm else x[9] * wind[2] - x[11] * wind[0],
        0.0 if calm else x[10] * wind[0] - x[9] * wind[1],
    )


@kernel
def position(x: State, p: Any) -> Vector:
    return x[0], x[1], x[2]


@kernel
def velocity(x: State, p: Any) -> Vector:
    return to_world(attitude(x[3], x[4], x[5]), (x[6], x[7], x[8]))


@kernel
def pose(x: State, p: Any) -> tuple[float, float, float, float, float, float]:
    return x[0], x[1], x[2], x[3], x[4], x[5]


@kernel
def outside(x: State, p: Any) -> float:
    """The number of the exceeded limit in `LIMITS`, the last one if there are several; x: the state with air data."""
    code = 1.0 if abs(x[4]) > STEEPEST else 0.0
    code = 2.0 if abs(x[3]) > LARGEST_BANK else code
    code = 3.0 if x[6] < SLOWEST else code
    code = 4.0 if abs(x[7]) > abs(x[6]) else code
    code = 5.0 if abs(x[8]) > abs(x[6]) else code
    code = 6.0 if x[6] > FASTEST else code
    fastest = abs(x[9]) + abs(x[10]) + abs(x[11])
    return 7.0 if fastest > FASTEST_TURN else code


@kernel
def measured(x: State, e: Errors, p: Any) -> State:
    """A state with errors of position and heading, and of speed along the body's forward axis."""
    return x[0] + e.x, x[1] + e.y, x[2] + e.z, x[3], x[4], x[5] + e.heading, x[6] + e.speed, *x[7:12]


@kernel
def felt(x: State, env: Surroundings, p: Any) -> State:
    """The true state with airspeed components in place of ground speed components, as air data sensors measure them."""
    air = through_air(x, attitude(x[3], x[4], x[5]), env)
    return *x[0:6], air[0], air[1], air[2], *x[9:12]
