"""The 20 problems of the CEC 2013 competition on niching (Li, Engelbrecht, Epitropakis, technical report, RMIT 2013).

Written from the report, as costs above the global optimum over the unit cube. `constants.npz` has the shifts and
rotation matrices of the composition functions, which the report gives as data files: Copyright 2013, Michael G.
Epitropakis, Xiaodong Li, and Andries Engelbrecht, all rights reserved; redistribution and use, with or without
modification, are permitted under the conditions of the simplified BSD license, and without any warranty.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from clearance.testing.searching import Function
from tests.given.niching.functions import (
    camel,
    composition,
    equal_maxima,
    griewank,
    himmelblau,
    modified_rastrigin,
    rastrigin,
    rosenbrock_griewank,
    shubert,
    sphere,
    uneven_maxima,
    uneven_trap,
    vincent,
    weierstrass,
)
from worker.engine.search.base import Floats

ACCURACIES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)


@dataclass(frozen=True)
class Niching:
    """A function over a box that has several global optima, all of the same value; maximised in the report.

    radius: two points closer than it count as one optimum. evaluations: what the competition permits.
    """

    name: str
    f: Function
    low: Floats
    high: Floats
    optimum: float
    optima: int
    radius: float
    evaluations: int

    def __call__(self, points: Floats) -> Floats:
        """Cost (m,) above the global optimum at points (m, n) of the unit cube."""
        return self.optimum - self.f(self.low + points * (self.high - self.low))

    @property
    def dimension(self) -> int:
        return len(self.low)

    def found(self, points: Floats, accuracy: float) -> int:
        """The number of global optima among these points (m, n) of the unit cube, as the competition counts them."""
        costs = self(points)
        seeds: list[Floats] = []
        count = 0
        for i in np.argsort(costs, kind="stable"):
            point = self.low + points[i] * (self.high - self.low)
            if all(np.linalg.norm(point - seed) > self.radius for seed in seeds):
                seeds.append(point)
                count += abs(costs[i]) <= accuracy
        return min(count, self.optima)


@cache
def _constants() -> dict[str, Floats]:
    with np.load(Path(__file__).with_name("constants.npz")) as data:
        return dict(data)


def _problem(
    number: int, f: Function, n: int, low: object, high: object, optimum: float, optima: int, radius: float, cost: int
) -> Niching:
    sides = [np.broadcast_to(np.asarray(side, dtype=float), n) for side in (low, high)]
    return Niching(f"F{number}", f, sides[0], sides[1], optimum, optima, radius, cost)


SIMPLE = (
    (1, uneven_trap, 1, 0, 30, 200.0, 2, 0.01, 50_000),
    (2, equal_maxima, 1, 0, 1, 1.0, 5, 0.01, 50_000),
    (3, uneven_maxima, 1, 0, 1, 1.0, 1, 0.01, 50_000),
    (4, himmelblau, 2, -6, 6, 200.0, 4, 0.01, 50_000),
    (5, camel, 2, (-1.9, -1.1), (1.9, 1.1), 1.031628453489877, 2, 0.5, 50_000),
    (6, shubert, 2, -10, 10, 186.7309088310239, 18, 0.5, 200_000),
    (7, vincent, 2, 0.25, 10, 1.0, 36, 0.2, 200_000),
    (8, shubert, 3, -10, 10, 2709.093505572820, 81, 0.5, 400_000),
    (9, vincent, 3, 0.25, 10, 1.0, 216, 0.2, 400_000),
    (10, modified_rastrigin, 2, 0, 1, -2.0, 12, 0.01, 200_000),
)
COMPOSED = {
    1: (
        (griewank, griewank, weierstrass, weierstrass, sphere, sphere),
        (1, 1, 1, 1, 1, 1),
        (1, 1, 8, 8, 1 / 5, 1 / 5),
    ),
    2: (
        (rastrigin, rastrigin, weierstrass, weierstrass, griewank, griewank, sphere, sphere),
        (1, 1, 1, 1, 1, 1, 1, 1),
        (1, 1, 10, 10, 1 / 10, 1 / 10, 1 / 7, 1 / 7),
    ),
    3: (
        (rosenbrock_griewank, rosenbrock_griewank, weierstrass, weierstrass, griewank, griewank),
        (1, 1, 2, 2, 2, 2),
        (1 / 4, 1 / 10, 2, 1, 2, 5),
    ),
    4: (
        (rastrigin, rastrigin, rosenbrock_griewank, rosenbrock_griewank, weierstrass, weierstrass, griewank, griewank),
        (1, 1, 1, 1, 1, 2, 2, 2),
        (4, 1, 4, 1, 1 / 10, 1 / 5, 1 / 10, 1 / 40),
    ),
}
"""The basic functions, sigma and lambda of the four composition functions."""
COMPOSITIONS = (
    (11, 1, 2, 200_000), (12, 2, 2, 200_000), (13, 3, 2, 200_000), (14, 3, 3, 400_000), (15, 4, 3, 400_000),
    (16, 3, 5, 400_000), (17, 4, 5, 400_000), (18, 3, 10, 400_000), (19, 4, 10, 400_000), (20, 4, 20, 400_000),
)  # fmt: skip
"""Number of the problem, of the composition, dimension, permitted evaluations."""


def _composed(number: int, which: int, n: int, cost: int) -> Niching:
    basic, sigma, scale = COMPOSED[which]
    data, count = _constants(), len(basic)
    matrices = data[f"cf{which}_{n}"] if which > 2 else np.tile(np.eye(n), (count, 1, 1))
    f = composition(basic, np.array(sigma, float), np.array(scale, float), data["optima"][:count, :n], matrices)
    return _problem(number, f, n, -5, 5, 0.0, count, 0.01, cost)


PROBLEMS: dict[str, Niching] = {
    p.name: p for p in [*(_problem(*row) for row in SIMPLE), *(_composed(*row) for row in COMPOSITIONS)]
}
