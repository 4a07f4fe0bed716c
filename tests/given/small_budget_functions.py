"""Test functions on which methods for small budgets are judged; nothing was tuned on them.

None is in `tests.given.functions_with_minima`. Half of them have many valleys.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from clearance.testing.searching import Function
from worker.engine.search.base import Floats


@dataclass(frozen=True)
class Judged:
    """A function on the cube [low, high]^n; `minimum` is its lowest value, NaN where an evaluation fails."""

    name: str
    dimension: int
    low: float
    high: float
    f: Function
    minimum: float
    valleys: bool
    """Whether it has many valleys."""
    minimiser: float | Floats = 0.0
    """Coordinates of a minimiser."""

    def at(self, seed: int) -> Function:
        """The function over the unit cube: axes permuted and mirrored, minimisers moved by at most 10 % of the side."""
        random = np.random.default_rng([seed, zlib.crc32(self.name.encode())])
        order, flip = random.permutation(self.dimension), random.random(self.dimension) < 0.5
        there = (np.broadcast_to(self.minimiser, self.dimension) - self.low) / (self.high - self.low)
        shift = there - np.clip(there - random.uniform(-0.1, 0.1, self.dimension), 0.03, 0.97)

        def value(points: Floats) -> Floats:
            turned = np.where(flip, 1.0 - points, points)[:, order]
            return self.f(self.low + (turned + shift) * (self.high - self.low))

        return value


def schwefel(x: Floats) -> Floats:
    """Valleys everywhere; the second lowest is far away. Beyond the box it rises."""
    inside = np.clip(x, -500.0, 500.0)
    return np.asarray(418.9828872724338 * x.shape[1] - (inside * np.sin(np.sqrt(np.abs(inside)))).sum(axis=1)) + (
        (x - inside) ** 2
    ).sum(axis=1)


def styblinski(x: Floats) -> Floats:
    return np.asarray(0.5 * (x**4 - 16 * x**2 + 5 * x).sum(axis=1))


def rotated(f: Function, dimension: int) -> Function:
    """The function of rotated coordinates: one fixed orthogonal matrix for each dimension."""
    q, _ = np.linalg.qr(np.random.default_rng(dimension).standard_normal((dimension, dimension)))
    return lambda x: f(turned(x, q))


def turned(x: Floats, axes: Floats) -> Floats:
    """Coordinates of points (..., n) along axes (..., k, n); unlike with `@`, no point's bits depend on others."""
    return np.asarray((x[..., None, :] * axes).sum(axis=-1))


def waves(x: Floats) -> Floats:
    """Rastrigin's function with half its barriers."""
    return np.asarray((x**2 - 5 * np.cos(2 * np.pi * x) + 5).sum(axis=1))


def salomon(x: Floats) -> Floats:
    r = np.sqrt((x**2).sum(axis=1))
    return np.asarray(1 - np.cos(2 * np.pi * r) + 0.1 * r)


def alpine(x: Floats) -> Floats:
    return np.asarray(np.abs(x * np.sin(x) + 0.1 * x).sum(axis=1))


def rosenbrock(x: Floats) -> Floats:
    return np.asarray((100 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1 - x[:, :-1]) ** 2).sum(axis=1))


def ellipsoid(x: Floats) -> Floats:
    return np.asarray((10.0 ** (3 * np.arange(x.shape[1]) / (x.shape[1] - 1)) * x**2).sum(axis=1))


def powers(x: Floats) -> Floats:
    return np.asarray((np.abs(x) ** np.arange(2, x.shape[1] + 2)).sum(axis=1))


def zakharov(x: Floats) -> Floats:
    weighted = (0.5 * np.arange(1, x.shape[1] + 1) * x).sum(axis=1)
    return np.asarray((x**2).sum(axis=1) + weighted**2 + weighted**4)


def half_fails(x: Floats) -> Floats:
    """A bowl whose evaluations fail beyond a plane 0.3 from its minimum: about 40 % of the box."""
    return np.where(x.sum(axis=1) > 0.3 * np.sqrt(x.shape[1]), np.nan, (np.abs(x) ** 1.5).sum(axis=1))


JUDGED: dict[str, Judged] = {
    j.name: j
    for j in (
        Judged("Schwefel 3", 3, -500, 500, schwefel, 0.0, True, 420.968746),
        Judged("Styblinski-Tang 6", 6, -5, 5, styblinski, -234.9969942, True, -2.903534),
        Judged("rotated waves 5", 5, -5, 5, rotated(waves, 5), 0.0, True),
        Judged("Salomon 4", 4, -20, 20, salomon, 0.0, True),
        Judged("Alpine 6", 6, -10, 10, alpine, 0.0, True),
        Judged("Rosenbrock 5", 5, -2, 2, rosenbrock, 0.0, False, 1.0),
        Judged("rotated ellipsoid 8", 8, -5, 5, rotated(ellipsoid, 8), 0.0, False),
        Judged("different powers 6", 6, -1, 1, powers, 0.0, False),
        Judged("Zakharov 4", 4, -5, 10, zakharov, 0.0, False),
        Judged("half fails 4", 4, -2, 2, half_fails, 0.0, False),
    )
}
