"""Functions of many valleys: half of them to set constants of methods for small budgets, half to check the choice.

Twelve kinds, each in both halves with another dimension, other constants and other axes.
`tests.given.small_budget_functions`, on which methods are judged, has none of them. Every seed moves the minimiser to a
random place of the inner 70 % of the box, turns the axes and draws the function's own parts. All minima are 0.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.testing.searching import Function
from tests.given.small_budget_functions import turned
from worker.engine.search.base import Floats


class Drawn(NamedTuple):
    """What a seed determines: random numbers for a function's own parts, and places (k, n) of the box as offsets."""

    random: np.random.Generator
    dimension: int
    places: Callable[[int], Floats]


@dataclass(frozen=True)
class Landscape:
    """A function of offsets from its minimiser, in sides of the box, at a random place and with turned axes."""

    name: str
    dimension: int
    f: Callable[[Drawn], Function]
    rotated: bool = True
    """Otherwise axes are only permuted and mirrored."""
    minimum: float = 0.0
    valleys: bool = True

    def minimiser(self, seed: int) -> Floats:
        """Where the function of a seed is lowest (n,)."""
        return self._random(seed).uniform(0.15, 0.85, self.dimension)

    def at(self, seed: int) -> Function:
        """The function over the unit cube."""
        n, random = self.dimension, self._random(seed)
        there = random.uniform(0.15, 0.85, n)
        axes = np.linalg.qr(random.standard_normal((n, n)))[0]
        if not self.rotated:
            axes = np.eye(n)[random.permutation(n)] * random.choice([-1.0, 1.0], n)
        f = self.f(Drawn(random, n, lambda count: turned(random.uniform(0.05, 0.95, (count, n)) - there, axes)))
        return lambda points: f(turned(points - there, axes))

    def _random(self, seed: int) -> np.random.Generator:
        return np.random.default_rng([seed, zlib.crc32(self.name.encode())])


def ripples(width: float, height: float) -> Callable[[Drawn], Function]:
    """Rastrigin's function over this width, with barriers of this height (10 as published)."""

    def drawn(_: Drawn) -> Function:
        return lambda z: ((width * z) ** 2 + height * (1 - np.cos(2 * np.pi * width * z))).sum(axis=1)

    return drawn


def ackley(width: float) -> Callable[[Drawn], Function]:
    def value(z: Floats) -> Floats:
        bowl = 20 * (1 - np.exp(-0.2 * np.sqrt(((width * z) ** 2).mean(axis=1))))
        return np.asarray(bowl + np.e - np.exp(np.cos(2 * np.pi * width * z).mean(axis=1)))

    return lambda _: value


def griewank(width: float) -> Callable[[Drawn], Function]:
    def value(z: Floats) -> Floats:
        x, i = width * z, np.arange(1, z.shape[1] + 1)
        return np.asarray(1 + (x**2).sum(axis=1) / 4000 - np.cos(x / np.sqrt(i)).prod(axis=1))

    return lambda _: value


def funnels(wide: float, height: float) -> Callable[[Drawn], Function]:
    """Two rippled bowls: the wider and shallower one is elsewhere (Lunacek, Whitley, Sutton, PPSN 2008)."""

    def drawn(given: Drawn) -> Function:
        places = given.places(20)
        other = places[np.argmax((places**2).sum(axis=1))]

        def value(z: Floats) -> Floats:
            bowls = np.minimum(50 * (z**2).sum(axis=1), 1.5 + 50 * wide * ((z - other) ** 2).sum(axis=1))
            return np.asarray(bowls + height * (1 - np.cos(2 * np.pi * 6 * z)).sum(axis=1))

        return value

    return drawn


def peaks(count: int) -> Callable[[Drawn], Function]:
    """Wells of random depth, shape and place, as in Gallagher and Yuan (IEEE Trans. Evol. Comput. 10, 2006)."""

    def drawn(given: Drawn) -> Function:
        n, random = given.dimension, given.random
        places = np.concatenate([np.zeros((1, n)), given.places(count - 1)])
        depth = np.concatenate([[1.0], random.uniform(0.2, 0.85, count - 1)])
        shape = 0.15 * np.sqrt(n) * 4.0 ** random.uniform(-0.5, 0.5, (count, n))

        def value(z: Floats) -> Floats:
            squares = (((z[:, None, :] - places) / shape) ** 2).sum(axis=2)
            return np.asarray(1 - (depth * np.exp(-0.5 * squares)).max(axis=1))

        return value

    return drawn


def curves(count: int) -> Callable[[Drawn], Function]:
    """A sum of curves of one coordinate, each with this many random valleys; the second lowest may be far away."""

    def drawn(given: Drawn) -> Function:
        n, random = given.dimension, given.random
        places = np.concatenate([np.zeros((1, n)), given.places(count - 1)])
        height = np.concatenate([np.zeros((1, n)), random.uniform(0.1, 0.6, (count - 1, n))])
        steep = random.uniform(10, 40, (count, n))
        return lambda z: (height + steep * (z[:, None, :] - places) ** 2).min(axis=1).sum(axis=1)

    return drawn


RHOMBUS = np.array([0.9980123, 0.4949272, 0.8666462, 1.4929395, 0.8666462])
TETRAHEDRON = np.array([1.0, 0.5, np.sqrt(3) / 2, 0.5, np.sqrt(3) / 6, np.sqrt(2 / 3)])


def atoms(lowest: Floats, energy: float, space: int) -> Callable[[Drawn], Function]:
    """Four atoms under the potential of Lennard-Jones in the plane or in space; the logarithm of their energy."""
    free = [(i, k) for i in range(1, 4) for k in range(space) if k < i]

    def value(z: Floats) -> Floats:
        at = np.zeros((len(z), 4, space))
        for (i, k), x in zip(free, (lowest + 2.5 * z).T, strict=True):
            at[:, i, k] = x
        first, second = np.triu_indices(4, 1)
        cubes = np.maximum(((at[:, first] - at[:, second]) ** 2).sum(axis=2), 0.01) ** -3
        return np.asarray(np.log1p(np.maximum((cubes**2 - 2 * cubes).sum(axis=1) - energy, 0.0)))

    return lambda _: value


def pieces(count: int) -> Callable[[Drawn], Function]:
    """The lowest of several quadratic functions, as the smallest of several distances is."""

    def drawn(given: Drawn) -> Function:
        n, random = given.dimension, given.random
        places = np.concatenate([np.zeros((1, n)), given.places(count - 1)])
        height = np.concatenate([[0.0], random.uniform(0.1, 0.6, count - 1)])
        maps = random.standard_normal((count, n, n)) * 4.0 ** random.uniform(-0.5, 0.5, (count, n, 1))

        def value(z: Floats) -> Floats:
            moved = turned(z[:, None, :] - places, maps)
            return np.asarray((height + 2 * (moved**2).sum(axis=2)).min(axis=1))

        return value

    return drawn


def approaches(count: int) -> Callable[[Drawn], Function]:
    """Closest approaches to several obstacles: distances in the plane, which not every direction changes much."""

    def drawn(given: Drawn) -> Function:
        n, random = given.dimension, given.random
        places = np.concatenate([np.zeros((1, n)), given.places(count - 1)])
        least = np.concatenate([[0.05], random.uniform(0.1, 0.5, count - 1)])
        maps = random.standard_normal((count, 2, n))

        def value(z: Floats) -> Floats:
            moved = z[:, None, :] - places
            plane = (turned(moved, maps) ** 2).sum(axis=2)
            return np.asarray((np.sqrt(least**2 + plane) + 0.3 * (moved**2).sum(axis=2)).min(axis=1) - 0.05)

        return value

    return drawn


def rings(width: float) -> Callable[[Drawn], Function]:
    """Schaffer's function F7: rings around the minimum that become narrower and lower."""

    def value(z: Floats) -> Floats:
        s = width * np.sqrt(z[:, 1:] ** 2 + z[:, :-1] ** 2)
        return np.asarray((np.sqrt(s) * (1 + np.sin(50 * s**0.2) ** 2)).mean(axis=1) ** 2)

    return lambda _: value


def bent(height: float) -> Callable[[Drawn], Function]:
    """Rastrigin's function of coordinates that are bent as those of Rosenbrock's valley."""

    def value(z: Floats) -> Floats:
        x = 3 * z
        w = np.concatenate([x[:, :1], 2 * (x[:, 1:] - x[:, :-1] ** 2)], axis=1)
        return np.asarray((w**2 + height * (1 - np.cos(3 * np.pi * w))).sum(axis=1))

    return lambda _: value


VALLEYS: tuple[dict[str, Landscape], dict[str, Landscape]] = (
    {
        j.name: j
        for j in (
            Landscape("low ripples 4", 4, ripples(8, 2)),
            Landscape("ripples 3", 3, ripples(6, 10), rotated=False),
            Landscape("Ackley's 6", 6, ackley(20)),
            Landscape("Griewank's 3", 3, griewank(40), rotated=False),
            Landscape("two funnels 5", 5, funnels(0.5, 0.5)),
            Landscape("twenty peaks 4", 4, peaks(20)),
            Landscape("curves 5", 5, curves(4), rotated=False),
            Landscape("atoms in the plane 5", 5, atoms(RHOMBUS, -5.073420858, 2), rotated=False),
            Landscape("pieces 6", 6, pieces(8)),
            Landscape("approaches 4", 4, approaches(6)),
            Landscape("rings 5", 5, rings(30), rotated=False),
            Landscape("bent 2", 2, bent(1.0)),
        )
    },
    {
        j.name: j
        for j in (
            Landscape("low ripples 7", 7, ripples(6, 3), rotated=False),
            Landscape("ripples 5", 5, ripples(5, 8)),
            Landscape("Ackley's 4", 4, ackley(40), rotated=False),
            Landscape("Griewank's 6", 6, griewank(60)),
            Landscape("two funnels 3", 3, funnels(0.3, 0.8), rotated=False),
            Landscape("fifty peaks 2", 2, peaks(50)),
            Landscape("curves 8", 8, curves(3), rotated=False),
            Landscape("atoms in space 6", 6, atoms(TETRAHEDRON, -6.0, 3), rotated=False),
            Landscape("pieces 3", 3, pieces(12)),
            Landscape("approaches 8", 8, approaches(10)),
            Landscape("rings 3", 3, rings(60)),
            Landscape("bent 4", 4, bent(0.5), rotated=False),
        )
    },
)
"""The functions on which constants are set, and those on which the choice is checked."""
