"""40 generated problems of rare failure: 2 to 20 parameters, 1 to 6 modes, with exact draws from every mode.

A mode is a half-space, a half-space with a curved surface, a corner of two, or a ball in a few of the directions. Its
cost may be scaled, capped far from the violation, saturated or rippled; none of this changes where it is negative. The
probability of the union counts each draw from a mode by the number of modes that it violates: Owen, Maximov, Chertkov,
Importance sampling the union of rare events (Electronic Journal of Statistics 13, 2019).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from scipy import special, stats

from tests.bench.rare.problem import Floats, Mode, Problem

DIMENSIONS = (2, 3, 4, 5, 6, 8, 10, 12, 15, 20)
DRAWS = 40_000
"""From every mode: the error of P is below 0.5 %, which `python -m tests.bench.rare` prints."""
PROBLEMS = 40


@dataclass(frozen=True)
class Shape:
    """Where one mode fails, in its own directions: `limit` <= 0; its probability by quadrature; `weighted` draws points
    of it with weights that are proportional to their likelihood ratio."""

    directions: Floats
    probability: float
    limit: Callable[[Floats], Floats]
    weighted: Callable[[np.random.Generator, int], tuple[Floats, Floats]]

    def values(self, u: Floats) -> Floats:
        return self.limit(u @ self.directions.T)

    def draws(self, random: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        """Points (count, n) of the mode and their weights."""
        own, weights = self.weighted(random, count)
        whole = random.standard_normal((count, self.directions.shape[1]))
        return whole + (own - whole @ self.directions.T) @ self.directions, weights


def _beyond(random: np.random.Generator, least: Floats) -> Floats:
    """Standard normal values above `least`."""
    return np.asarray(-special.ndtri_exp(special.log_ndtr(-least) + np.log(random.random(len(least)))))


def _solved(decreasing: Callable[[float], float], value: float, low: float, high: float) -> float:
    """Where a decreasing function has this value."""
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if decreasing(middle) > value else (low, middle)
    return low


def curved(directions: Floats, probability: float, bends: Floats) -> Shape:
    """b - z1 + sum of bends z_k^2; without bends a half-space."""
    nodes, of_node = np.polynomial.hermite_e.hermegauss(60)
    z = np.array(list(product(nodes, repeat=len(bends))))
    share = np.prod(list(product(of_node / of_node.sum(), repeat=len(bends))), axis=1)
    b = _solved(lambda b: float(special.ndtr(-(b + z**2 @ bends)) @ share), probability, -2.0, 20.0)
    spread = (1.0 + 2.0 * b * bends) ** -0.5  # of the likely points across

    def weighted(random: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        unit = random.standard_normal((count, len(bends)))
        across = unit * spread
        least = b + across**2 @ bends
        ratio = np.exp((np.sum(unit**2, axis=1) - np.sum(across**2, axis=1)) / 2.0)
        return np.column_stack([_beyond(random, least), across]), special.ndtr(-least) * ratio

    return Shape(directions, probability, lambda y: b - y[:, 0] + y[:, 1:] ** 2 @ bends, weighted)


def corner(directions: Floats, probability: float, part: float) -> Shape:
    """Two half-spaces at a right angle, both violated; `part` of the exponent is the first's."""
    p = np.array([probability**part, probability ** (1.0 - part)])
    least = -special.ndtri(p)

    def weighted(random: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        own = np.column_stack([_beyond(random, np.full(count, b)) for b in least])
        return own, np.ones(count)

    return Shape(directions, probability, lambda y: np.max(least - y, axis=1), weighted)


def ball(directions: Floats, probability: float, radius: float) -> Shape:
    """A ball in the directions; its distance is set by its probability."""
    k = len(directions)
    distance = _solved(lambda d: float(stats.ncx2.cdf(radius**2, k, d**2)), probability, 0.0, 40.0)
    centre = np.eye(k)[0] * distance

    def weighted(random: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        ways = random.standard_normal((count, k))
        ways *= radius * random.random((count, 1)) ** (1.0 / k) / np.linalg.norm(ways, axis=1, keepdims=True)
        own = centre + ways
        return own, np.exp((np.sum(centre**2) - np.sum(own**2, axis=1)) / 2.0)

    return Shape(directions, probability, lambda y: np.linalg.norm(y - centre, axis=1) - radius, weighted)


def _shape(random: np.random.Generator, first: Floats, probability: float) -> Shape:
    """A mode in the direction `first`, of a kind that chance chooses."""
    n = len(first)
    size = min(n, int(random.integers(2, 4)))
    basis = np.linalg.qr(np.column_stack([first, random.standard_normal((n, size - 1))]))[0].T
    basis *= np.sign(basis @ first)[0]
    match random.choice(["plane", "plane", "curved", "curved", "corner", "ball"]):
        case "plane":
            return curved(basis[:1], probability, np.empty(0))
        case "curved":
            return curved(basis, probability, random.uniform(-0.05, 0.2, size - 1))
        case "corner":
            turned = np.array([basis[0] + basis[1], basis[0] - basis[1]]) / np.sqrt(2.0)
            return corner(turned, probability, random.uniform(0.35, 0.65))
        case _:
            return ball(basis, probability, random.uniform(0.8, 2.5))


def _cost(random: np.random.Generator, shape: Shape) -> Callable[[Floats], Floats]:
    """The cost of a mode: its limit, scaled, and possibly capped, saturated or rippled."""
    scale, kind = 10.0 ** random.uniform(-0.3, 0.3), random.choice(["plain", "plain", "capped", "saturated", "rippled"])
    wave = random.standard_normal(shape.directions.shape[1]) * 2.0

    def cost(u: Floats) -> Floats:
        value = shape.values(u)
        if kind == "capped":
            value = np.minimum(value, 2.5)
        elif kind == "saturated":
            value = 3.0 * np.tanh(value / 3.0)
        elif kind == "rippled":
            value = value * (1.0 + 0.3 * np.sin(u @ wave))
        return scale * value

    return cost


def _directions(random: np.random.Generator, count: int, n: int) -> list[Floats]:
    """Unit vectors, no two of them within 53 degrees; some of a few parameters only."""
    found: list[Floats] = []
    while len(found) < count:
        way = random.standard_normal(n)
        if random.random() < 0.5:
            way[random.permutation(n)[: n - min(n, int(random.integers(2, 5)))]] = 0.0
        way /= np.linalg.norm(way)
        if all(way @ other < 0.6 for other in found):
            found.append(way)
        elif random.random() < 0.01:
            found = []
    return found


@cache
def generated(index: int) -> Problem:
    """The problem of this number; even ones are for setting, odd ones for judging."""
    random = np.random.default_rng([20261125, index])
    n, count = DIMENSIONS[index // 2 % len(DIMENSIONS)], 1 + (index // 2 + index // 20) % 6
    if n == 2:
        count = min(count, 4)
    largest = 10.0 ** random.uniform(-7.5, -3.0)
    likely = largest * 10.0 ** -np.concatenate([[0.0], random.uniform(0.0, 1.3, count - 1)])
    shapes = [_shape(random, way, p) for way, p in zip(_directions(random, count, n), likely, strict=True)]
    costs = [_cost(random, shape) for shape in shapes]
    modes, error = [], 0.0
    for shape in shapes:
        points, weights = shape.draws(random, DRAWS)
        shared = 1.0 / np.sum([other.values(points) <= 1e-9 for other in shapes], axis=0)
        part = float(shared @ weights / weights.sum())
        error += shape.probability**2 * float((weights / weights.sum()) ** 2 @ (shared - part) ** 2)
        modes.append(Mode(shape.probability * part, _start(random, shape, points), shape.values))
    total = sum(mode.probability for mode in modes)
    return Problem(
        f"generated {index}",
        n,
        lambda u: np.min([cost(u) for cost in costs], axis=0),
        total,
        ("setting", "judging")[index % 2],
        modes=tuple(modes),
        source=f"{count} modes, error {np.sqrt(error) / total:.2%}",
    )


def _start(random: np.random.Generator, shape: Shape, points: Floats) -> Floats:
    """A violation of the mode as a search would leave it: not at its most likely point."""
    point = points[int(random.integers(len(points)))]
    further = point * random.uniform(1.0, 1.8)
    return further if shape.values(further[None])[0] <= 0.0 else point
