"""F-16 ground collision avoidance: Heidlauf, Collins, Bolender and Bak (ARCH 2018), as the ARCH-COMP reports use it.

An F-16 dives with banked wings; its autopilot rolls the wings level, then pulls up. Roll, pitch and heading are the
parameters; it must stay above the ground for 15 s. Written from the paper and the published model (Stevens and Lewis):
13 states and three integrators of an LQR controller; modes change 30 times a second.
"""

from __future__ import annotations

from math import nan, pi

import numpy as np

from tests.given.falsification.aerodynamics import atmosphere, coefficients, power_slope, thrust
from tests.given.falsification.problem import Falsification
from worker.engine.kernels.cached import cached
from worker.engine.search.base import Floats

SECONDS, STEP, LOGIC = 15, 1 / 120, 4
"""Horizon [s], integration step [s], and steps per step of the autopilot and sample."""
SPEED, ATTACK, POWER = 540.0, np.radians(2.1215), 9.0
START = 2338.0
"""Altitude [ft]; with it, the least altitude over all parameters is half a foot below the ground."""
GRAVITY, RM, HE = 32.17, 1.57e-3, 160.0
"""Gravity [ft/s^2]; one over the mass [1/slug]; angular momentum of the engine [slug ft^2/s]."""
AREA, SPAN, CHORD, PILOT = 300.0, 30.0, 11.32, 15.0
"""Of the wing [ft^2, ft]; how far before the centre of gravity accelerations are measured [ft]."""
C1, C2, C3, C4, C5, C6, C7, C8, C9 = -0.770, 0.02755, 1.055e-4, 1.642e-6, 0.9604, 1.759e-2, 1.792e-5, -0.7336, 1.587e-5
"""Of the moments of inertia, as Stevens and Lewis number them."""
LONGITUDINAL = np.array([-156.8801506723475, -31.037008068526642, -38.72983346216317])
LATERAL = np.array(
    [[37.84483, -25.40956, -6.82876, -332.88343, -17.15997], [-23.91233, 5.69968, -21.63431, 64.49490, -88.36203]]
)
"""LQR gains: elevator on attack, pitch rate, integral of Nz; aileron and rudder on sideslip, roll and yaw rate, and the
integrals of roll rate and Ny."""
TRIM_ATTACK, TRIM_THROTTLE, TRIM_ELEVATOR = 0.0389, 0.1395, -0.7496
ROLL, PULL, STANDBY = 0, 1, 2
LEVEL, SLOW, DECK, NZ, PULLING = np.radians(5.0), np.radians(10.0), 1000.0, 5.0, 2.0
"""Level wings [rad], low roll rate [rad/s], altitude of activation [ft], demanded Nz [g], shortest pull-up [s]."""


@cached
def _wrapped(angle: float) -> float:
    return float(angle - 2 * pi * np.round(angle / (2 * pi)))


@cached
def _next(mode: int, x: Floats, t: float, since: float) -> int:
    """The mode after this state; since: when the pull-up began."""
    rising = _wrapped(x[4] - x[1]) > 0.0
    if mode == STANDBY and not rising and x[11] < DECK:
        return ROLL
    if mode == ROLL and abs(x[6]) < SLOW and abs(_wrapped(x[3])) < LEVEL:
        return PULL
    if mode == PULL and rising and t >= since + PULLING:
        return STANDBY
    return mode


@cached
def _slopes(x: Floats, mode: int, out: Floats, c: Floats) -> None:
    """Of speed, attack, sideslip, roll, pitch, heading, p, q, r, north, east, altitude, power, and three integrals."""
    v, a, b, phi, theta, psi, p, q, r = x[:9]
    nz_wanted = NZ if mode == PULL else 0.0
    roll_wanted = -4.0 * _wrapped(phi) - 2.0 * p if mode == ROLL else 0.0
    elevator = TRIM_ELEVATOR - (LONGITUDINAL * np.array([a - TRIM_ATTACK, q, x[13]])).sum()
    lateral = np.array([b, p, r, x[14], x[15]])
    elevator = np.radians(min(max(elevator, -25.0), 25.0))
    aileron = np.radians(min(max(-(LATERAL[0] * lateral).sum(), -21.5), 21.5))
    rudder = np.radians(min(max(-(LATERAL[1] * lateral).sum(), -30.0), 30.0))
    mach, pressure = atmosphere(v, x[11])
    rates = np.array([p * SPAN, q * CHORD, r * SPAN]) / (2.0 * v)
    coefficients(a, b, elevator, aileron, rudder, rates, c)
    u, side, w = v * np.cos(a) * np.cos(b), v * np.sin(b), v * np.sin(a) * np.cos(b)
    st, ct, sp, cp, ss, cs = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi), np.sin(psi), np.cos(psi)
    force = RM * pressure * AREA
    ay, az = force * c[1], force * c[2]
    u_dot = r * side - q * w - GRAVITY * st + force * c[0] + RM * thrust(x[12], x[11], mach)
    v_dot = p * w - r * u + GRAVITY * ct * sp + ay
    w_dot = q * u - p * side + GRAVITY * ct * cp + az
    out[0] = (u * u_dot + side * v_dot + w * w_dot) / v
    out[1] = (u * w_dot - w * u_dot) / (u * u + w * w)
    out[2] = (v * v_dot - side * out[0]) * np.cos(b) / (u * u + w * w)
    out[3] = p + st / ct * (q * sp + r * cp)
    out[4] = q * cp - r * sp
    out[5] = (q * sp + r * cp) / ct
    moment = pressure * AREA
    out[6] = (C2 * p + C1 * r + C4 * HE) * q + moment * SPAN * (C3 * c[3] + C4 * c[5])
    out[7] = (C5 * p - C7 * HE) * r + C6 * (r * r - p * p) + moment * CHORD * C7 * c[4]
    out[8] = (C8 * p - C2 * r + C9 * HE) * q + moment * SPAN * (C4 * c[3] + C9 * c[5])
    out[9] = u * ct * cs + side * (sp * st * cs - cp * ss) + w * (cp * st * cs + sp * ss)
    out[10] = u * ct * ss + side * (sp * st * ss + cp * cs) + w * (cp * st * ss - sp * cs)
    out[11] = u * st - side * sp * ct - w * cp * ct
    out[12] = power_slope(x[12], TRIM_THROTTLE)
    out[13] = -(az - PILOT * out[7]) / GRAVITY - 1.0 - nz_wanted
    out[14] = p * np.cos(a - TRIM_ATTACK) + r * np.sin(a - TRIM_ATTACK) - roll_wanted
    out[15] = (ay + PILOT * out[8]) / GRAVITY + r


@cached
def simulated(inputs: Floats, altitude: float, step: float, steps: int, logic: int) -> Floats:
    """Altitude [ft], roll [rad] and mode (samples, 3) from roll, pitch and heading [rad]; NaN once it has diverged."""
    x = np.zeros(16)
    x[0], x[1], x[11], x[12] = SPEED, ATTACK, altitude, POWER
    x[3:6] = inputs
    signals = np.full((steps // logic + 1, 3), nan)
    k, c = np.zeros((4, 16)), np.zeros(6)
    mode, since = ROLL, 0.0
    for i in range(steps + 1):
        if i % logic == 0:
            following = _next(mode, x, i * step, since)
            if following == PULL and mode != PULL:
                since = i * step
            mode = following
            signals[i // logic, 0], signals[i // logic, 1], signals[i // logic, 2] = x[11], x[3], mode
            if not np.isfinite(x).all():
                break
        _slopes(x, mode, k[0], c)
        _slopes(x + 0.5 * step * k[0], mode, k[1], c)
        _slopes(x + 0.5 * step * k[1], mode, k[2], c)
        _slopes(x + step * k[2], mode, k[3], c)
        x = x + step / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3])
    return signals


def lowest(signals: Floats) -> float:
    """The lowest altitude [ft] until the ground, beyond which the model means nothing; NaN if it diverged before."""
    altitude = signals[:, 0]
    hit = np.flatnonzero(altitude <= 0.0)
    return float(altitude[: hit[0] + 1].min()) if len(hit) else float(altitude.min())


RANGES = (
    (pi / 4 - pi / 20, pi / 4 + pi / 30),
    (-0.4 * pi, -0.4 * pi + pi / 20),
    (-pi / 4 - pi / 8, -pi / 4 + pi / 8),
)
"""Roll, pitch and heading of ARCH-COMP."""


def simulate(inputs: Floats) -> Floats:
    """Altitude [ft], roll [rad] and mode (samples, 3), 30 a second."""
    return np.asarray(simulated(inputs, START, STEP, round(SECONDS / STEP), LOGIC))


PROBLEMS = {"F16": Falsification("F16", "always[0,15] altitude > 0", RANGES, simulate, lowest)}
