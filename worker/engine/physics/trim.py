"""Trim of a fixed-wing airframe and its linearisation there, in plain Python, once per campaign.

Stevens, Lewis and Johnson, Aircraft Control and Simulation (2016), sections 3.6 and 3.7: straight level flight solved
for angle of attack, elevator and throttle; derivatives by central differences.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import NoTrim
from worker.engine.physics import aerodynamics
from worker.engine.physics.aerodynamics import Airframe, Constants, Trimmed
from worker.engine.physics.space import Attitude

LARGEST_ALPHA = 0.35
"""The largest angle of attack of an accepted trim [rad]; beyond it the linear lift model is not valid."""
RESIDUAL = 1e-9
"""The largest accepted residual acceleration [m/s2], [rad/s2]."""
DIFFERENCE = 1e-5
"""Step of the central differences [m/s], [rad], [rad/s], [throttle]."""

STATES = ("u", "v", "w", "p", "q", "r", "phi", "theta", "de", "da", "dr", "dt")

_accelerations: Callable[..., Any] = plain(aerodynamics.accelerations)
_constants: Callable[..., Any] = plain(aerodynamics.constants)


def airframe(values: Mapping[str, float]) -> Airframe:
    """The airframe from the parameters of a scenario by path."""
    return Airframe(*(values[f"vehicle.{name}"] for name in Airframe._fields))


def trimmed(body: Airframe, speed: float) -> Trimmed:
    """Trim for straight level flight at a speed [m/s]; raises NoTrim if the airframe cannot sustain it."""
    made = Constants(*_constants(body))
    if not speed > 0.0:
        raise NoTrim(f"level flight needs a speed above 0, got {speed:g} m/s: raise start.speed")

    def left(unknown: NDArray[np.float64]) -> list[float]:
        alpha, elevator, throttle = (float(v) for v in unknown)
        along, _, down, _, pitch, _ = motion(made, level(speed, alpha, elevator, throttle))
        return [along, down, pitch]

    from scipy.optimize import root  # imported late: a campaign's process must start fast

    found = root(left, [0.05, -0.05, 0.2], options={"xtol": 1e-13})
    alpha, elevator, throttle = (float(v) for v in found.x)
    if not max(map(abs, left(found.x))) < RESIDUAL:
        raise NoTrim(f"found no level flight at {speed:g} m/s: change start.speed or the airframe's coefficients")
    _refuse(alpha > LARGEST_ALPHA, speed, f"an angle of attack of {alpha:.3g} rad, at most {LARGEST_ALPHA:g}", "raise")
    _refuse(alpha < -LARGEST_ALPHA, speed, f"an angle of attack of {alpha:.3g} rad", "lower")
    _refuse(throttle > 1.0, speed, f"a throttle of {throttle:.3g}, at most 1", "lower")
    _refuse(throttle < 0.0, speed, f"a throttle of {throttle:.3g}, at least 0", "raise")
    _refuse(abs(elevator) > body.stop, speed, f"an elevator of {elevator:.3g} rad beyond its stop", "change")
    return Trimmed(alpha, elevator, throttle)


def level(speed: float, alpha: float, elevator: float, throttle: float) -> list[float]:
    """Wings-level horizontal flight as values of `STATES`."""
    u, w = speed * math.cos(alpha), speed * math.sin(alpha)
    return [u, 0.0, w, 0.0, 0.0, 0.0, 0.0, alpha, elevator, 0.0, 0.0, throttle]


def motion(made: Any, values: list[float]) -> list[float]:
    """Derivatives of u, v, w, p, q, r at values of `STATES` in still air; made: `Constants` of the airframe."""
    v, rates, (phi, theta) = tuple(values[0:3]), tuple(values[3:6]), values[6:8]
    a = Attitude(math.sin(phi), math.cos(phi), math.sin(theta), math.cos(theta), 0.0, 1.0)
    linear, angular = _accelerations(a, v, v, rates, tuple(values[8:12]), made)
    return [*linear, *angular]


def derivatives(body: Airframe, speed: float, at: Trimmed) -> NDArray[np.float64]:
    """The Jacobian (6, 12) of the derivatives of u, v, w, p, q, r with respect to `STATES` at a trim."""
    made = Constants(*_constants(body))
    table = np.empty((6, len(STATES)))
    for k in range(len(STATES)):
        ends = []
        for sign in (1.0, -1.0):
            values = level(speed, *at)
            values[k] += sign * DIFFERENCE
            ends.append(np.array(motion(made, values)))
        table[:, k] = (ends[0] - ends[1]) / (2.0 * DIFFERENCE)
    return table


def _refuse(exceeded: bool, speed: float, needs: str, what: str) -> None:
    if exceeded:
        raise NoTrim(f"level flight at {speed:g} m/s needs {needs}: {what} start.speed or change the airframe")
