"""Areas in the plane: of {V < 1}, and of the region of attraction by simulation."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from tests.bench.attraction.polynomials import Polynomial, values

RAYS = 2_000


def area(v: Polynomial, reach: float = 6.0) -> float:
    """Of the part of {V < 1} that is seen from the origin, by the first crossing of each ray."""
    angle = np.arange(RAYS) * (2.0 * np.pi / RAYS)
    ray = np.array([np.cos(angle), np.sin(angle)])
    radii = np.linspace(0.0, reach, 401)
    outside = values(v, ray[:, :, None] * radii) >= 1.0
    if not outside.any(axis=1).all():
        return float("inf")
    first = outside.argmax(axis=1)
    low, high = radii[first - 1], radii[first]
    for _ in range(50):
        middle = (low + high) / 2
        beyond = values(v, ray * middle) >= 1.0
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return float(0.5 * (low**2).sum() * (2.0 * np.pi / RAYS))


def of_limit_cycle(field: list[Polynomial], start: tuple[float, float]) -> float:
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
