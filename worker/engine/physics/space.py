"""Vectors and attitudes in space as kernels, without branches or libm calls.

Stevens, Lewis and Johnson, Aircraft Control and Simulation (2016), section 1.3: Euler angles in the order yaw, pitch,
roll; body axes forward, right, down; world axes north, east, down.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from worker.engine.kernels.maths import HALF_PI, atan2, kernel, sincos

Vector = tuple[float, float, float]


class Attitude(NamedTuple):
    """Sines and cosines of roll, pitch and yaw."""

    s_roll: float
    c_roll: float
    s_pitch: float
    c_pitch: float
    s_yaw: float
    c_yaw: float


@kernel
def attitude(roll: float, pitch: float, yaw: float) -> Attitude:
    """Sines and cosines of the three angles [rad]."""
    s_roll, c_roll = sincos(roll)
    s_pitch, c_pitch = sincos(pitch)
    s_yaw, c_yaw = sincos(yaw)
    return Attitude(s_roll, c_roll, s_pitch, c_pitch, s_yaw, c_yaw)


@kernel
def to_world(a: Attitude, v: Vector) -> Vector:
    """A vector from body axes to world axes: the matrix of equation 3.38 of Srikanthakumar."""
    # roll, pitch and yaw are undone one after another: 12 products instead of 23 with the matrix
    y = a.c_roll * v[1] - a.s_roll * v[2]
    z = a.s_roll * v[1] + a.c_roll * v[2]
    x = a.c_pitch * v[0] + a.s_pitch * z
    down = a.c_pitch * z - a.s_pitch * v[0]
    return a.c_yaw * x - a.s_yaw * y, a.s_yaw * x + a.c_yaw * y, down


@kernel
def to_body(a: Attitude, v: Vector) -> Vector:
    """A vector from world axes to body axes."""
    x = a.c_yaw * v[0] + a.s_yaw * v[1]
    y = a.c_yaw * v[1] - a.s_yaw * v[0]
    forward = a.c_pitch * x - a.s_pitch * v[2]
    z = a.s_pitch * x + a.c_pitch * v[2]
    return forward, a.c_roll * y + a.s_roll * z, a.c_roll * z - a.s_roll * y


@kernel
def euler_rates(a: Attitude, rates: Vector) -> Vector:
    """Rates of roll, pitch and yaw [rad/s] from body rates; singular at a pitch of 90 degrees."""
    turning = (rates[1] * a.s_roll + rates[2] * a.c_roll) / a.c_pitch
    return rates[0] + turning * a.s_pitch, rates[1] * a.c_roll - rates[2] * a.s_roll, turning


@kernel
def dot3(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def norm3(v: Vector) -> float:
    """Length of a vector."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def velocity_vector(speed: float, heading: float, climb: float) -> Vector:
    """The velocity from speed [m/s], heading from north over east and climb angle [rad]; axes with z down."""
    s_climb, c_climb = sincos(climb)
    s, c = sincos(heading)
    return speed * c_climb * c, speed * c_climb * s, -speed * s_climb


@kernel
def arcsine(x: float) -> float:
    """Arcsine of x in [0, 1] [rad], pi/2 beyond; NaN stays NaN."""
    inside = x if x < 1.0 else 1.0
    angle = atan2(inside, math.sqrt(1.0 - inside * inside))
    return (angle if x < 1.0 else HALF_PI) + 0.0 * x
