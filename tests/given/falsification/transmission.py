"""Automatic transmission: Hoxha, Abbas and Fainekos (ARCH 2014), the model of Simulink's `sldemo_autotrans`.

Engine, torque converter, four gears with a shift logic, and the vehicle; throttle [%] and brake [ft lb] are inputs.
Constants are those that the benchmark is published with. The shift logic runs every 0.04 s and shifts when the speed
has been beyond the threshold of the throttle for two of its steps.
"""

from __future__ import annotations

from math import nan, pi

import numpy as np

from tests.given.falsification.problem import Falsification
from worker.engine.kernels.cached import cached
from worker.engine.search.base import Floats

SECONDS, STEP, LOGIC = 30, 0.01, 4
"""Horizon [s], integration step [s], and steps of integration per step of the shift logic and sample."""
RATE = round(1 / (STEP * LOGIC))
"""Samples per second."""
PIECES = 4
"""Of throttle and of brake, 7.5 s each."""
WAIT = 2

THROTTLE = np.array([0.0, 20, 30, 40, 50, 60, 70, 80, 90, 100])
SPEED = np.array([800.0, 1200, 1600, 2000, 2400, 2800, 3200, 3600, 4000, 4400, 4800])
TORQUE = np.array(
    [
        [-40.0, -44, -49, -53, -57, -61, -65, -70, -74, -78, -82],
        [215, 117, 85, 66, 44, 29, 10, -2, -13, -22, -32],
        [245, 208, 178, 148, 122, 104, 85, 66, 48, 33, 18],
        [264, 260, 241, 219, 193, 167, 152, 133, 119, 96, 85],
        [264, 279, 282, 275, 260, 238, 223, 208, 189, 171, 152],
        [267, 290, 293, 297, 290, 275, 260, 256, 234, 212, 193],
        [267, 297, 305, 305, 305, 301, 293, 282, 267, 249, 226],
        [267, 301, 308, 312, 319, 323, 319, 316, 297, 279, 253],
        [267, 301, 312, 319, 327, 327, 327, 327, 312, 293, 267],
        [267, 301, 312, 319, 327, 334, 334, 334, 319, 305, 275],
    ]
)
"""Engine torque [ft lb] by throttle [%] and engine speed [rpm]."""
RATIO = np.array(
    [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.81, 0.82, 0.83, 0.84, 0.85, 0.86, 0.87, 0.88, 0.89, 0.9, 0.92, 0.94]
)
CAPACITY = np.array(
    [
        137.4652, 137.0650, 135.8644, 135.6644, 137.5653, 140.3666, 145.2689, 152.8725, 162.9773, 164.2779, 166.1788,
        167.9797, 170.0807, 172.7820, 175.3832, 179.5852, 183.5871, 189.8901, 197.6938, 215.9024, 244.5160,
    ]
)  # fmt: skip
GAIN = np.array(
    [
        2.232, 2.075, 1.975, 1.846, 1.72, 1.564, 1.409, 1.254, 1.096, 1.08, 1.061, 1.043, 1.028, 1.012, 1.002, 1.002,
        1.001, 0.998, 0.999, 1.001, 1.002,
    ]
)  # fmt: skip
GEARS = np.array([2.393, 1.450, 1.000, 0.677])
UP_THROTTLE, DOWN_THROTTLE = np.array([0.0, 25, 35, 50, 90, 100]), np.array([0.0, 5, 40, 50, 90, 100])
UP = np.array([[10.0, 30, 50], [10, 30, 50], [15, 30, 50], [23, 41, 60], [40, 70, 100], [40, 70, 100]])
DOWN = np.array([[5.0, 20, 35], [5, 20, 35], [5, 25, 40], [5, 30, 50], [30, 50, 80], [30, 50, 80]])
"""Speeds [mph] at which gear 1, 2, 3 shifts up, and gear 2, 3, 4 shifts down, by throttle."""
INERTIA, FINAL_DRIVE, DRAG0, DRAG2, WHEEL, VEHICLE = 0.021991488, 3.23, 40.0, 0.02, 1.0, 12.0941478573
"""Of engine and impeller; ratio; road load; wheel radius [ft]; of the vehicle."""
MPH = 2.0 * pi * WHEEL * 60.0 / 5280.0


@cached
def _along(x: float, xs: Floats) -> tuple[int, float]:
    """The interval of x and its fraction in it, beyond the ends too: Simulink's look-up tables extrapolate."""
    i = min(max(int(np.searchsorted(xs, x, side="right")) - 1, 0), len(xs) - 2)
    return i, (x - xs[i]) / (xs[i + 1] - xs[i])


@cached
def _slopes(engine: float, wheel: float, gear: int, throttle: float, brake: float) -> tuple[float, float]:
    """Of engine speed [rpm/s] and wheel speed [rpm/s]."""
    i, a = _along(throttle, THROTTLE)
    j, b = _along(engine, SPEED)
    low = TORQUE[i, j] + b * (TORQUE[i, j + 1] - TORQUE[i, j])
    high = TORQUE[i + 1, j] + b * (TORQUE[i + 1, j + 1] - TORQUE[i + 1, j])
    ratio = GEARS[gear] * FINAL_DRIVE * wheel / engine
    k, c = _along(ratio, RATIO)
    impeller = (engine / (CAPACITY[k] + c * (CAPACITY[k + 1] - CAPACITY[k]))) ** 2
    output = GEARS[gear] * impeller * (GAIN[k] + c * (GAIN[k + 1] - GAIN[k]))
    speed = MPH * wheel
    load = np.sign(speed) * (DRAG0 + DRAG2 * speed * speed + brake)
    return (low + a * (high - low) - impeller) / INERTIA, (FINAL_DRIVE * output - load) / VEHICLE


@cached
def simulated(inputs: Floats, step: float, steps: int, logic: int) -> Floats:
    """Speed [mph], engine speed [rpm] and gear (samples, 3); Runge-Kutta of order 4."""
    engine, wheel, gear, up, down = 1000.0, 0.0, 0, 0, 0
    signals = np.full((steps // logic + 1, 3), nan)
    pieces = len(inputs) // 2
    for i in range(steps + 1):
        piece = min(i * pieces // steps, pieces - 1)
        throttle, brake = inputs[piece], inputs[pieces + piece]
        if i % logic == 0:
            speed = MPH * wheel
            t, a = _along(throttle, UP_THROTTLE)
            up = up + 1 if gear < 3 and speed > UP[t, gear] + a * (UP[t + 1, gear] - UP[t, gear]) else 0
            t, a = _along(throttle, DOWN_THROTTLE)
            low = DOWN[t, gear - 1] + a * (DOWN[t + 1, gear - 1] - DOWN[t, gear - 1])
            down = down + 1 if gear > 0 and speed < low else 0
            if up > WAIT:
                gear, up = gear + 1, 0
            elif down > WAIT:
                gear, down = gear - 1, 0
            signals[i // logic] = speed, engine, gear + 1.0
        a0, b0 = _slopes(engine, wheel, gear, throttle, brake)
        a1, b1 = _slopes(engine + 0.5 * step * a0, wheel + 0.5 * step * b0, gear, throttle, brake)
        a2, b2 = _slopes(engine + 0.5 * step * a1, wheel + 0.5 * step * b1, gear, throttle, brake)
        a3, b3 = _slopes(engine + step * a2, wheel + step * b2, gear, throttle, brake)
        engine = min(max(engine + step / 6.0 * (a0 + 2.0 * a1 + 2.0 * a2 + a3), 600.0), 6000.0)
        wheel += step / 6.0 * (b0 + 2.0 * b1 + 2.0 * b2 + b3)
    return signals


def simulate(inputs: Floats) -> Floats:
    """Speed [mph], engine speed [rpm] and gear (samples, 3), 25 a second."""
    return np.asarray(simulated(inputs, STEP, round(SECONDS / STEP), LOGIC))


def at1(signals: Floats) -> float:
    return float((120.0 - signals[: 20 * RATE + 1, 0]).min())


def at2(signals: Floats) -> float:
    return float((4750.0 - signals[: 10 * RATE + 1, 1]).min())


def at6(signals: Floats, seconds: int, speed: float) -> float:
    """Scaled by 3,000 rpm and the speed, which have different units."""
    slow = (3000.0 - signals[:, 1]).min() / 3000.0
    return float(max(-slow, (speed - signals[: seconds * RATE + 1, 0]).min() / speed))


REQUIREMENTS = {
    "AT1": (at1, "always[0,20] speed < 120"),
    "AT2": (at2, "always[0,10] rpm < 4750"),
    "AT6a": (lambda s: at6(s, 4, 35.0), "(always[0,30] rpm < 3000) implies (always[0,4] speed < 35)"),
    "AT6b": (lambda s: at6(s, 8, 50.0), "(always[0,30] rpm < 3000) implies (always[0,8] speed < 50)"),
    "AT6c": (lambda s: at6(s, 20, 65.0), "(always[0,30] rpm < 3000) implies (always[0,20] speed < 65)"),
}
RANGES = ((0.0, 100.0),) * PIECES + ((0.0, 325.0),) * PIECES
PROBLEMS = {
    name: Falsification(name, text, RANGES, simulate, robustness) for name, (robustness, text) in REQUIREMENTS.items()
}
