"""Chasing cars: Hu, Lygeros and Sastry (2000), as the ARCH-COMP falsification reports state model and requirements.

Five cars in a row. Throttle and brake drive the first; each of the others follows the one before it in three modes,
chasing, keeping and braking, which change at distances of 5, 10, 15 and 20. Positions y1 to y5 begin 10 apart.
"""

from __future__ import annotations

from math import nan

import numpy as np

from tests.given.falsification.problem import Falsification, always, eventually
from worker.engine.kernels.cached import cached
from worker.engine.search.base import Floats

SECONDS, STEP, EACH = 100, 0.02, 5
"""Horizon [s], integration step [s], and steps per sample."""
RATE = round(1 / (STEP * EACH))
"""Samples per second."""
PIECES = 5
"""Of throttle and of brake, 20 s each."""
KEEPING, CHASING, BRAKING = 0, 1, 2


@cached
def _slopes(y: Floats, v: Floats, mode: Floats, throttle: float, brake: float, out: Floats) -> None:
    out[0, 0], out[1, 0] = v[0], -throttle - brake * v[0]
    for car in range(1, 5):
        out[0, car] = v[car] if mode[car] == KEEPING else -v[car]
        out[1, car] = 1.0 if mode[car] == CHASING else (-v[car] if mode[car] == BRAKING else 0.0)


@cached
def simulated(inputs: Floats, step: float, steps: int, each: int) -> Floats:
    """Positions (samples, 5) under throttle and brake, each in pieces of equal length; Runge-Kutta of order 4."""
    y, v = np.array([0.0, 10.0, 20.0, 30.0, 40.0]), np.zeros(5)
    mode = np.zeros(5)
    signals = np.full((steps // each + 1, 5), nan)
    k, at, to = np.zeros((4, 2, 5)), np.zeros(5), np.zeros(5)
    fractions = (0.0, 0.5 * step, 0.5 * step, step)
    pieces = len(inputs) // 2
    for i in range(steps + 1):
        for car in range(1, 5):
            gap = y[car] - y[car - 1]
            if (mode[car] == KEEPING and gap >= 15.0) or (mode[car] == BRAKING and gap >= 20.0):
                mode[car] = CHASING
            elif mode[car] == KEEPING and gap <= 5.0:
                mode[car] = BRAKING
            elif mode[car] == CHASING and gap <= 10.0:
                mode[car] = KEEPING
        if i % each == 0:
            signals[i // each] = y
        piece = min(i * pieces // steps, pieces - 1)
        throttle, brake = inputs[piece], inputs[pieces + piece]
        for stage in range(4):
            for car in range(5):
                before = k[max(stage - 1, 0)]
                at[car] = y[car] + fractions[stage] * before[0, car] if stage else y[car]
                to[car] = v[car] + fractions[stage] * before[1, car] if stage else v[car]
            _slopes(at, to, mode, throttle, brake, k[stage])
        for car in range(5):
            y[car] += step / 6.0 * (k[0, 0, car] + 2.0 * k[1, 0, car] + 2.0 * k[2, 0, car] + k[3, 0, car])
            v[car] += step / 6.0 * (k[0, 1, car] + 2.0 * k[1, 1, car] + 2.0 * k[2, 1, car] + k[3, 1, car])
    return signals


def simulate(inputs: Floats) -> Floats:
    """Positions (samples, 5), ten a second."""
    return np.asarray(simulated(inputs, STEP, round(SECONDS / STEP), EACH))


def cc1(y: Floats) -> float:
    return float((40.0 - (y[:, 4] - y[:, 3])).min())


def cc2(y: Floats) -> float:
    return float(eventually(y[:, 4] - y[:, 3] - 15.0, 0, 30 * RATE)[: 70 * RATE + 1].min())


def cc3(y: Floats) -> float:
    near = always(20.0 - (y[:, 1] - y[:, 0]), 0, 20 * RATE)
    far = eventually(y[:, 4] - y[:, 3] - 40.0, 0, 20 * RATE)
    return float(np.maximum(near, far)[: 80 * RATE + 1].min())


def cc4(y: Floats) -> float:
    held = always(y[:, 4] - y[:, 3] - 8.0, 0, 5 * RATE)
    return float(eventually(held, 0, 30 * RATE)[: 65 * RATE + 1].min())


def cc5(y: Floats) -> float:
    if_near = -always(y[:, 1] - y[:, 0] - 9.0, 0, 5 * RATE)
    then = always(y[:, 4] - y[:, 3] - 9.0, 5 * RATE, 20 * RATE)
    size = min(len(if_near), len(then))
    return float(eventually(np.maximum(if_near[:size], then[:size]), 0, 8 * RATE)[: 72 * RATE + 1].min())


REQUIREMENTS = {
    "CC1": (cc1, "always[0,100] y5 - y4 <= 40"),
    "CC2": (cc2, "always[0,70] eventually[0,30] y5 - y4 >= 15"),
    "CC3": (cc3, "always[0,80] (always[0,20] y2 - y1 <= 20) or (eventually[0,20] y5 - y4 >= 40)"),
    "CC4": (cc4, "always[0,65] eventually[0,30] always[0,5] y5 - y4 >= 8"),
    "CC5": (cc5, "always[0,72] eventually[0,8] (always[0,5] y2 - y1 >= 9) implies (always[5,20] y5 - y4 >= 9)"),
}
PROBLEMS = {
    name: Falsification(name, text, ((0.0, 1.0),) * (2 * PIECES), simulate, robustness)
    for name, (robustness, text) in REQUIREMENTS.items()
}
