"""The region of attraction of the reversed Van der Pol oscillator, by simulation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from campaigns.certificates.polynomials import Monomial, Polynomial

VAN_DER_POL: list[Polynomial] = [{(0, 1): -1.0}, {(1, 0): 1.0, (2, 1): 1.0, (0, 1): -1.0}]
"""x' = -y, y' = x + (x^2 - 1) y."""


def exactly(p: Mapping[Monomial, float]) -> Polynomial:
    """Coefficients as the fractions that they are."""
    return {m: Fraction(c) for m, c in p.items() if c != 0}


def values(p: Polynomial, points: Iterable[Any]) -> Any:
    """p at columns of coordinates."""
    xs = list(points)
    total: Any = 0.0
    for m, c in p.items():
        term: Any = float(c)
        for x, power in zip(xs, m, strict=True):
            term = term * x**power
        total = total + term
    return total


def area_of_limit_cycle(field: list[Polynomial], start: tuple[float, float]) -> float:
    """The area inside the limit cycle that trajectories approach backwards in time: the boundary of the region."""

    def backwards(_: float, x: np.ndarray) -> list[float]:
        return [-float(values(f, x)) for f in field]

    def upwards(_: float, x: np.ndarray) -> float:
        return float(x[1])

    upwards.direction = 1.0  # type: ignore[attr-defined]
    found = solve_ivp(
        backwards, (0.0, 80.0), start, "DOP853", rtol=1e-11, atol=1e-12, events=upwards, dense_output=True
    )
    times = np.linspace(found.t_events[0][-2], found.t_events[0][-1], 100_001)
    x, y = found.sol(times)
    return float(abs(0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum()))
