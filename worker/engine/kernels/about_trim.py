"""The declaration of a closed loop about its trim as polynomials, and simulations of the same loop by its kernels.

A loop of a vehicle and its controller, whose references are held, in at most four states: deviations from the trim.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.kernels.views import STILL

Polynomial = dict[tuple[int, ...], Fraction]
"""{exponents of the states: coefficient}."""


@dataclass(frozen=True)
class Trimmed:
    """The loop at the nominal values: dx/dt of the deviations x, which is exact where no limit is reached."""

    trim: tuple[float, ...]
    """The states at the trim."""
    flow: tuple[Polynomial, ...]
    limits: tuple[float | None, ...]
    """The largest magnitude of each deviation for which the polynomials apply; None without one."""
    demand: tuple[float, ...]
    """The velocity that is demanded [m/s], in the world frame."""
    held: tuple[tuple[str, float, str], ...]
    """What is held: words, value and unit."""


@dataclass(frozen=True)
class AboutTrim:
    """The polynomial model of a controller and its vehicle about trim.

    trimmed(nominal values by path, trim of the vehicle or ()) -> `Trimmed`; raises `NoTrim`.
    place(deviations, trim) -> (state of the vehicle, state of the controller); pick(their derivatives) -> those of the
    deviations: kernels.
    """

    states: tuple[tuple[str, str, str], ...]
    """Name, symbol and unit of each."""
    trimmed: Callable[[Mapping[str, float], Any], Trimmed]
    place: Callable[[Any, Any], tuple[Any, Any]]
    pick: Callable[[Any, Any], tuple[float, ...]]


def simulation(derivative: Any, command: Any, about: AboutTrim, constants: tuple[Any, Any], at: Trimmed) -> Any:
    """rates(deviations (n,)) and returns(starts (m, n), limits (n,), norm (n, n), fall, step [s], steps): which starts
    stay within the limits until their norm has fallen to that fraction, by RK4; compiled."""
    place, pick, trim, demand, (vehicle, controller) = about.place, about.pick, at.trim, at.demand, constants
    n = len(at.trim)

    @compiled
    def rates(x: Any, found: Any) -> None:
        state, memory = place(x, trim)
        inputs, inner = command(0.0, state, memory, demand, controller)
        rate = pick(derivative(0.0, state, inputs, STILL, vehicle), inner)
        for k in range(n):
            found[k] = rate[k]

    @compiled
    def size(x: Any, limits: Any, norm: Any) -> float:
        """x' norm x; infinite beyond the limits. In loops, since an array a step would take most of the time."""
        found = 0.0
        for i in range(n):
            if not abs(x[i]) <= limits[i]:
                return np.inf
            for j in range(n):
                found += x[i] * norm[i, j] * x[j]
        return found

    @compiled
    def returns(starts: Any, limits: Any, norm: Any, fall: float, step: float, steps: int) -> Any:
        done = np.zeros(len(starts), np.bool_)
        k, total, y = np.empty(n), np.empty(n), np.empty(n)
        for row in range(len(starts)):
            x = starts[row].copy()
            now = size(x, limits, norm)
            least = fall * fall * now
            for _ in range(steps):
                if not least < now < np.inf:
                    break
                for stage in range(4):
                    reach = 1.0 if stage == 3 else 0.5
                    weight = 1.0 if stage == 0 or stage == 3 else 2.0
                    for i in range(n):
                        y[i] = x[i] + reach * step * k[i] if stage else x[i]
                    rates(y, k)
                    for i in range(n):
                        total[i] = weight * k[i] + (total[i] if stage else 0.0)
                for i in range(n):
                    x[i] += step / 6.0 * total[i]
                now = size(x, limits, norm)
            done[row] = now <= least < np.inf
        return done

    return rates, returns
