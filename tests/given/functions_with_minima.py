"""Test functions with known minima, for every search method: Dixon and Szego (1978), Jones et al. (1993), and others.

The last two are ours: one falls in steps into a narrow basin, one has a region without values at whose edge it is low
but not lowest.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from itertools import product

import numpy as np

from campaigns.results.base import EXCLUDED
from clearance.testing.searching import Function
from worker.engine.search.base import Floats


@dataclass(frozen=True)
class TestFunction:
    """A function on a box; also defined outside the box, where it is not lower.

    minimisers (k, n): all minimisers in the box and its surroundings. It is NaN at
    excluded points.
    """

    __test__ = False

    name: str
    dimension: int
    low: Floats
    high: Floats
    f: Function
    minimum: float
    minimisers: Floats

    def gap(self, value: float) -> float:
        """Relative difference of a value from the minimum; the absolute difference if the minimum is 0."""
        return (value - self.minimum) / (abs(self.minimum) or 1.0)


@dataclass(frozen=True)
class OnUnitCube:
    """A test function over the unit cube; called with points (m, n) it gives values (m,), NaN where excluded."""

    of: TestFunction
    shift: Floats
    """In shares of the box: what the minimisers are moved by."""
    status: int = EXCLUDED

    def __call__(self, points: Floats) -> Floats:
        of = self.of
        return of.f(of.low + (points - self.shift) * (of.high - of.low))

    @property
    def dimension(self) -> int:
        return self.of.dimension

    @property
    def minimum(self) -> float:
        return self.of.minimum

    @property
    def minimisers(self) -> Floats:
        """The minimisers inside the unit cube (k, n)."""
        of = self.of
        points = (of.minimisers - of.low) / (of.high - of.low) + self.shift
        return points[((points >= 0.0) & (points <= 1.0)).all(axis=1)]

    def gap(self, value: float) -> float:
        return self.of.gap(value)


def on_unit_cube(name: str, shift_seed: int | None = None) -> OnUnitCube:
    """The function of this name over the unit cube, its minimisers moved by 5 to 25 % of each side.

    The first minimiser stays at least 5 % of the side away from the faces. Without a seed nothing is moved.
    """
    of = FUNCTIONS[name]
    if shift_seed is None:
        return OnUnitCube(of, np.zeros(of.dimension))
    random = np.random.default_rng([shift_seed, zlib.crc32(name.encode())])
    first = (of.minimisers[0] - of.low) / (of.high - of.low)
    by = random.uniform(0.05, 0.25, of.dimension) * random.choice([-1.0, 1.0], of.dimension)
    moved = np.where((first + by < 0.05) | (first + by > 0.95), first - by, first + by)
    return OnUnitCube(of, np.clip(moved, 0.05, 0.95) - first)


def branin(x: Floats) -> Floats:
    a, b = x[:, 0], x[:, 1]
    bent = b - 5.1 / (4 * np.pi**2) * a**2 + 5 / np.pi * a - 6
    return np.asarray(bent**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(a) + 10)


def goldstein_price(x: Floats) -> Floats:
    a, b = x[:, 0], x[:, 1]
    one = 1 + (a + b + 1) ** 2 * (19 - 14 * a + 3 * a**2 - 14 * b + 6 * a * b + 3 * b**2)
    two = 30 + (2 * a - 3 * b) ** 2 * (18 - 32 * a + 12 * a**2 + 48 * b - 36 * a * b + 27 * b**2)
    return np.asarray(one * two)


def camel(x: Floats) -> Floats:
    a, b = x[:, 0], x[:, 1]
    return np.asarray((4 - 2.1 * a**2 + a**4 / 3) * a**2 + a * b + (-4 + 4 * b**2) * b**2)


def shubert(x: Floats) -> Floats:
    i = np.arange(1, 6)
    a, b = ((i * np.cos((i + 1) * x[:, k, None] + i)).sum(axis=1) for k in (0, 1))
    return np.asarray(a * b)


SHEKEL_A = np.array(
    [
        [4] * 4, [1] * 4, [8] * 4, [6] * 4, [3, 7, 3, 7], [2, 9, 2, 9], [5, 5, 3, 3], [8, 1, 8, 1], [6, 2, 6, 2],
        [7, 3.6, 7, 3.6],
    ]
)  # fmt: skip
SHEKEL_C = np.array([0.1, 0.2, 0.2, 0.4, 0.4, 0.6, 0.3, 0.7, 0.5, 0.5])


def shekel(m: int) -> Function:
    def value(x: Floats) -> Floats:
        return -(1 / (((x[:, None, :] - SHEKEL_A[:m]) ** 2).sum(axis=2) + SHEKEL_C[:m])).sum(axis=1)

    return value


HARTMAN_C = np.array([1.0, 1.2, 3.0, 3.2])
HARTMAN3 = (
    np.array([[3, 10, 30], [0.1, 10, 35], [3, 10, 30], [0.1, 10, 35]]),
    np.array([[0.3689, 0.117, 0.2673], [0.4699, 0.4387, 0.747], [0.1091, 0.8732, 0.5547], [0.03815, 0.5743, 0.8828]]),
)
HARTMAN6 = (
    np.array(
        [[10, 3, 17, 3.5, 1.7, 8], [0.05, 10, 17, 0.1, 8, 14], [3, 3.5, 1.7, 10, 17, 8], [17, 8, 0.05, 10, 0.1, 14]]
    ),
    np.array(
        [
            [0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886], [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
            [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650], [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381],
        ]
    ),
)  # fmt: skip


def hartman(a: Floats, p: Floats) -> Function:
    return lambda x: -(HARTMAN_C * np.exp(-(a * (x[:, None, :] - p) ** 2).sum(axis=2))).sum(axis=1)


def rastrigin(x: Floats) -> Floats:
    return np.asarray((x**2 - 10 * np.cos(2 * np.pi * x) + 10).sum(axis=1))


def ackley(x: Floats) -> Floats:
    bowl = -20 * np.exp(-0.2 * np.sqrt((x**2).mean(axis=1)))
    return np.asarray(bowl - np.exp(np.cos(2 * np.pi * x).mean(axis=1)) + 20 + np.e)


def griewank(x: Floats) -> Floats:
    waves = np.cos(x / np.sqrt(np.arange(1, x.shape[1] + 1))).prod(axis=1)
    return np.asarray((x**2).sum(axis=1) / 4000 - waves + 1)


def levy(x: Floats) -> Floats:
    w = 1 + (x - 1) / 4
    inner, last = w[:, :-1], w[:, -1]
    middle = ((inner - 1) ** 2 * (1 + 10 * np.sin(np.pi * inner + 1) ** 2)).sum(axis=1)
    ends = np.sin(np.pi * w[:, 0]) ** 2 + (last - 1) ** 2 * (1 + np.sin(2 * np.pi * last) ** 2)
    return np.asarray(middle + ends)


BASIN, DECOY = np.array([0.27, 0.61, 0.44]), np.array([0.8, 0.3, 0.7])


def narrow(x: Floats) -> Floats:
    """A wide bowl down to 1, and a basin of 0.08 across with a cliff around it, cut by steps, down to -1."""
    distance = np.abs(x - BASIN).max(axis=1)
    basin = -1 + 30 * distance + 0.05 * np.floor(distance / 0.01)
    return np.where(distance < 0.04, basin, 1 + ((x - DECOY) ** 2).sum(axis=1))


HOLE, VALLEY = np.array([0.7, 0.6, 0.5]), np.array([0.2, 0.25, 0.7])


def excluded(x: Floats) -> Floats:
    """Decreases towards a ball of excluded points, to -0.7 at its edge; the minimum, -1, is in another valley."""
    outside = np.sqrt(((x - HOLE) ** 2).sum(axis=1)) - 0.25
    valley = -1 + 40 * ((x - VALLEY) ** 2).sum(axis=1)
    return np.where(outside < 0, np.nan, np.minimum(-0.7 + outside, valley))


def _on(name: str, f: Function, low: object, high: object, minimum: float, minimisers: object) -> TestFunction:
    at = np.atleast_2d(np.asarray(minimisers, dtype=float))
    n = at.shape[1]
    lower, upper = (np.broadcast_to(np.asarray(side, dtype=float), n) for side in (low, high))
    return TestFunction(name, n, lower, upper, f, minimum, at)


PI = float(np.pi)
CAMEL = (0.08984201310031806, -0.7126564030207396)
SHUBERT = (-1.4251284281, -0.8003211003)
"""The two coordinates of one period, in either order."""
SHUBERTS = [
    (a + 2 * PI * i, b + 2 * PI * j)
    for a, b in (SHUBERT, SHUBERT[::-1])
    for i, j in sorted(product(range(-3, 4), repeat=2), key=lambda ij: (max(map(abs, ij)), ij))
]

FUNCTIONS: dict[str, TestFunction] = {
    t.name: t
    for t in (
        _on("Branin", branin, [-5, 0], [10, 15], 0.39788735772973816, [[PI, 2.275], [-PI, 12.275], [3 * PI, 2.475]]),
        _on("Goldstein-Price", goldstein_price, -2, 2, 3.0, [0, -1]),
        _on("six-hump camel", camel, [-3, -2], [3, 2], -1.0316284534898774, [CAMEL, (-CAMEL[0], -CAMEL[1])]),
        _on("Shubert", shubert, -10, 10, -186.7309088310239, SHUBERTS),
        _on("Hartman 3", hartman(*HARTMAN3), 0, 1, -3.862782147820756, [0.11461434, 0.55564885, 0.85254695]),
        _on(
            "Hartman 6", hartman(*HARTMAN6), 0, 1, -3.322368011415515,
            [0.20168952, 0.15001069, 0.47687398, 0.27533243, 0.31165162, 0.65730054],
        ),
        _on("Shekel 5", shekel(5), 0, 10, -10.15319967905823, [4.00003715, 4.00013327, 4.00003715, 4.00013327]),
        _on("Shekel 7", shekel(7), 0, 10, -10.40294056681868, [4.00057291, 4.00068936, 3.99948971, 3.99960616]),
        _on("Shekel 10", shekel(10), 0, 10, -10.53640981669204, [4.00074653, 4.00059293, 3.99966339, 3.9995098]),
        _on("Rastrigin 5", rastrigin, -5.12, 5.12, 0.0, np.zeros(5)),
        _on("Ackley 10", ackley, -32.768, 32.768, 0.0, np.zeros(10)),
        _on("Griewank 5", griewank, -600, 600, 0.0, np.zeros(5)),
        _on("Levy 8", levy, -10, 10, 0.0, np.ones(8)),
        _on("narrow basin", narrow, 0, 1, -1.0, BASIN),
        _on("excluded region", excluded, 0, 1, -1.0, VALLEY),
    )
}  # fmt: skip

PUBLISHED = {
    "Shekel 5": (103, 155),
    "Shekel 7": (97, 145),
    "Shekel 10": (97, 145),
    "Hartman 3": (83, 199),
    "Hartman 6": (213, 571),
    "Branin": (63, 195),
    "Goldstein-Price": (101, 191),
    "six-hump camel": (113, 285),
    "Shubert": (2883, 2967),
}
"""Jones, Perttunen, Stuckman (1993), table 2: evaluations of DIRECT to within 1 % and 0.01 % of the minimum."""
