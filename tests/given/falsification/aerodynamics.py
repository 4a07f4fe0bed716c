"""Aerodynamic coefficients, engine and atmosphere of the F-16: tables of Stevens and Lewis, polynomials of Morelli.

Stevens and Lewis, Aircraft Control and Simulation (1992), appendix A, from wind tunnel data (NASA TP 1538); Morelli,
Global nonlinear parametric modeling with application to F-16 aerodynamics (ACC 1998). Angles in radians unless named.
"""

from __future__ import annotations

import numpy as np

from worker.engine.kernels.cached import cached
from worker.engine.search.base import Floats

DAMPING = np.array(
    [
        [-0.267, -0.110, 0.308, 1.34, 2.08, 2.91, 2.76, 2.05, 1.50, 1.49, 1.83, 1.21],
        [0.882, 0.852, 0.876, 0.958, 0.962, 0.974, 0.819, 0.483, 0.590, 1.21, -0.493, -1.04],
        [-0.108, -0.108, -0.188, 0.110, 0.258, 0.226, 0.344, 0.362, 0.611, 0.529, 0.298, -2.27],
        [-8.80, -25.8, -28.9, -31.4, -31.2, -30.7, -27.7, -28.2, -29.0, -29.8, -38.3, -35.3],
        [-0.126, -0.026, 0.063, 0.113, 0.208, 0.230, 0.319, 0.437, 0.680, 0.100, 0.447, -0.330],
        [-0.360, -0.359, -0.443, -0.420, -0.383, -0.375, -0.329, -0.294, -0.230, -0.210, -0.120, -0.100],
        [-7.21, -0.540, -5.23, -5.26, -6.11, -6.64, -5.69, -6.00, -6.20, -6.40, -6.60, -6.00],
        [-0.380, -0.363, -0.378, -0.386, -0.370, -0.453, -0.550, -0.582, -0.595, -0.637, -1.02, -0.840],
        [0.061, 0.052, 0.052, -0.012, -0.013, -0.024, 0.050, 0.150, 0.130, 0.158, 0.240, 0.150],
    ]
)
"""CXq, CYr, CYp, CZq, Clr, Clp, Cmq, Cnr, Cnp by angle of attack, -10 to 45 degrees in steps of 5."""
IDLE = np.array(
    [
        [1060.0, 670, 880, 1140, 1500, 1860], [635, 425, 690, 1010, 1330, 1700], [60, 25, 345, 755, 1130, 1525],
        [-1020, -170, -300, 350, 910, 1360], [-2700, -1900, -1300, -247, 600, 1100],
        [-3600, -1400, -595, -342, -200, 700],
    ]
)  # fmt: skip
MILITARY = np.array(
    [
        [12680.0, 9150, 6200, 3950, 2450, 1400], [12680, 9150, 6313, 4040, 2470, 1400],
        [12610, 9312, 6610, 4290, 2600, 1560], [12640, 9839, 7090, 4660, 2840, 1660],
        [12390, 10176, 7750, 5320, 3250, 1930], [11680, 9848, 8050, 6100, 3800, 2310],
    ]
)  # fmt: skip
"""Thrust [lb] by Mach number, 0 to 1 in steps of 0.2, and altitude, 0 to 50,000 ft in steps of 10,000. Power stays
below 50 % here, so that the afterburner's table is not needed."""

POWERS = {
    "cxq": (4.833383e-1, 8.644627, 1.131098e1, -7.422961e1, 6.075776e1),
    "cyp": (-1.006733e-1, 8.679799e-1, 4.260586, -6.923267),
    "cyr": (8.071648e-1, 1.189633e-1, 4.177702, -9.162236),
    "cz": (-1.378278e-1, -4.211369, 4.775187, -1.026225e1, 8.399763),
    "czq": (-3.054956e1, -4.132305e1, 3.292788e2, -6.848038e2, 4.080244e2),
    "clp": (-4.126806e-1, -1.189974e-1, 1.247721, -7.391132e-1),
    "clr": (6.250437e-2, 6.067723e-1, -1.101964, 9.100087, -1.192672e1),
    "cmq": (-5.19153, -3.554716, -3.598636e1, 2.247355e2, -4.120991e2, 2.411750e2),
    "cnp": (2.677652e-2, -3.298246e-1, 1.926178e-1, 4.013325, -4.404302),
    "cnr": (-3.698756e-1, -1.167551e-1, -7.641297e-1),
}
"""Coefficients of polynomials in the angle of attack, lowest power first."""
CXQ, CYP, CYR, CZ, CZQ, CLP, CLR, CMQ, CNP, CNR = (np.array(powers) for powers in POWERS.values())


@cached
def _polynomial(powers: Floats, a: float) -> float:
    value = 0.0
    for power in powers[::-1]:
        value = value * a + power
    return value


@cached
def coefficients(a: float, b: float, e: float, d: float, r: float, rates: Floats, out: Floats) -> None:
    """CX, CY, CZ, Cl, Cm, Cn at angle of attack a, sideslip b, elevator e, aileron d, rudder r.

    rates: roll, pitch and yaw rate, made dimensionless. The benchmark adds the damping of Stevens and Lewis to that of
    Morelli, which is kept: the altitude that an aircraft loses depends on it.
    """
    p, q, s = rates
    x = min(max((np.degrees(a) + 10.0) / 5.0, -1e6), 1e6)
    i = min(max(int(np.floor(x)), 0), 10)
    damping = DAMPING[:, i] + (x - i) * (DAMPING[:, i + 1] - DAMPING[:, i])
    a2, a3, a4 = a * a, a * a * a, a * a * a * a
    cx = -1.943367e-2 + 2.136104e-1 * a - 2.903457e-1 * e * e - 3.348641e-3 * e - 2.060504e-1 * a * e
    cx += 6.988016e-1 * a2 - 9.035381e-1 * a3
    cl = -1.05853e-1 * b - 5.776677e-1 * a * b - 1.672435e-2 * a2 * b + 1.357256e-1 * b * b + 2.172952e-1 * a * b * b
    cl += 3.464156 * a3 * b - 2.835451 * a4 * b - 1.098104 * a2 * b * b
    cl_d = -1.463144e-1 - 4.07391e-2 * a + 3.253159e-2 * b + 4.851209e-1 * a2 + 2.978850e-1 * a * b
    cl_d += -3.746393e-1 * a2 * b - 3.213068e-1 * a3
    cl_r = 2.635729e-2 - 2.192910e-2 * a - 3.152901e-3 * b - 5.817803e-2 * a * b + 4.516159e-1 * a2 * b
    cl_r += -4.928702e-1 * a3 * b - 1.579864e-2 * b * b
    cm = -2.029370e-2 + 4.660702e-2 * a - 6.012308e-1 * e - 8.062977e-2 * a * e + 8.320429e-2 * e * e
    cm += 5.018538e-1 * a2 * e + 6.378864e-1 * e**3 + 4.226356e-1 * a * e * e
    cn = 2.993363e-1 * b + 6.594004e-2 * a * b - 2.003125e-1 * b * b - 6.233977e-2 * a * b * b - 2.107885 * a2 * b
    cn += 2.141420 * a2 * b * b + 8.476901e-1 * a3 * b
    cn_d = -3.348717e-2 + 4.276655e-2 * a + 6.573646e-3 * b + 3.535831e-1 * a * b - 1.373308 * a2 * b
    cn_d += 1.237582 * a3 * b + 2.302543e-1 * a2 - 2.512876e-1 * a3 + 1.588105e-1 * b**3 - 5.199526e-1 * a * b**3
    cn_r = -8.115894e-2 - 1.156580e-2 * a + 2.514167e-2 * b + 2.038748e-1 * a * b - 3.337476e-1 * a2 * b
    cn_r += 1.004297e-1 * a2
    out[0] = cx + (_polynomial(CXQ, a) + damping[0]) * q
    out[1] = -1.145916 * b + 6.016057e-2 * d + 1.642479e-1 * r
    out[1] += (_polynomial(CYP, a) + damping[2]) * p + (_polynomial(CYR, a) + damping[1]) * s
    out[2] = _polynomial(CZ, a) * (1.0 - b * b) - 4.354000e-1 * e + (_polynomial(CZQ, a) + damping[3]) * q
    out[3] = cl + (_polynomial(CLP, a) + damping[5]) * p + (_polynomial(CLR, a) + damping[4]) * s + cl_d * d + cl_r * r
    out[4] = cm + (_polynomial(CMQ, a) + damping[6]) * q
    out[5] = cn + (_polynomial(CNP, a) + damping[8]) * p + (_polynomial(CNR, a) + damping[7]) * s + cn_d * d + cn_r * r


@cached
def atmosphere(speed: float, altitude: float) -> tuple[float, float]:
    """Mach number and dynamic pressure [lb/ft^2], of the speed [ft/s] and altitude [ft]."""
    factor = 1.0 - 0.703e-5 * altitude
    temperature = 390.0 if altitude >= 35000.0 else 519.0 * factor
    density = 2.377e-3 * factor**4.14
    return speed / np.sqrt(1.4 * 1716.3 * temperature), 0.5 * density * speed * speed


@cached
def thrust(power: float, altitude: float, mach: float) -> float:
    """Thrust [lb] at a power level of at most 50 %."""
    h, m = max(altitude, 0.01) / 10000.0, 5.0 * mach
    i, j = min(int(h), 4), max(min(int(m), 4), 0)
    levels = np.empty(2)
    for k, table in enumerate((IDLE, MILITARY)):
        low = table[j, i] + (h - i) * (table[j, i + 1] - table[j, i])
        high = table[j + 1, i] + (h - i) * (table[j + 1, i + 1] - table[j + 1, i])
        levels[k] = low + (m - j) * (high - low)
    return float(levels[0] + (levels[1] - levels[0]) * power / 50.0)


@cached
def power_slope(power: float, throttle: float) -> float:
    """The rate of the power level [%/s] towards what a throttle below 0.77 commands, while both are below 50 %."""
    difference = 64.94 * throttle - power
    rate = 1.0 if difference <= 25.0 else (0.1 if difference >= 50.0 else 1.9 - 0.036 * difference)
    return rate * difference
