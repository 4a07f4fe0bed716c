"""Random landscapes over the unit cube with a known minimum, in two halves: one for setting constants, one for judging.

`landscape(number, half)` makes one of ten kinds, of 2 to 20 parameters. Axes are permuted, mirrored and sheared, and
values scaled and shifted, by number. The halves draw from different seeds and from different constants, so that what is
set on one half is judged on functions that were never evaluated. The judging half is run by the score board only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from clearance.testing.searching import Function
from worker.engine.search.base import Floats

Half = Literal["setting", "judging"]


@dataclass(frozen=True)
class Landscape:
    """A function over the unit cube, NaN where it fails; a search succeeds at or below the target.

    volume: of the region at or below the target, where the kind states it.
    """

    name: str
    kind: str
    minimum: float
    minimiser: Floats
    target: float
    function: Function
    volume: float | None = None

    def __call__(self, points: Floats) -> Floats:
        """Values (m,) at points (m, n)."""
        return self.function(points)

    @property
    def dimension(self) -> int:
        return len(self.minimiser)


@dataclass(frozen=True)
class Constants:
    """What the kinds of one half are made from; a number chooses among them."""

    salt: int
    dimensions: tuple[int, ...]
    few: tuple[int, ...]
    """Dimensions of kinds whose difficulty grows with the volume."""
    shear: float
    wells: tuple[int, ...]
    widths: tuple[float, ...]
    """Of the deepest well, per square root of the dimension."""
    levels: tuple[int, ...]
    steepness: tuple[float, ...]
    bends: tuple[float, ...]
    jumps: tuple[float, ...]
    volumes: tuple[float, ...]
    conditions: tuple[float, ...]
    waves: tuple[int, ...]
    holes: tuple[float, ...]
    """Distance of the failing half-space from the minimiser, and radius of failing balls."""
    integers: tuple[int, ...]
    modes: tuple[int, ...]


HALVES: dict[Half, Constants] = {
    "setting": Constants(
        salt=20260114, dimensions=(3, 5, 8, 12, 18), few=(3, 5), shear=0.4, wells=(4, 9, 16), widths=(0.05, 0.08),
        levels=(15, 35), steepness=(8.0, 60.0), bends=(0.0, 1.5), jumps=(0.5, 2.0), volumes=(2e-3, 3e-4),
        conditions=(1e2, 1e4, 1e6), waves=(3, 5), holes=(0.02, 0.15), integers=(4, 9, 21), modes=(2, 4),
    ),
    "judging": Constants(
        salt=71830905, dimensions=(2, 4, 6, 10, 20), few=(2, 4, 6), shear=0.55, wells=(3, 7, 20), widths=(0.045, 0.1),
        levels=(20, 50), steepness=(15.0, 90.0), bends=(0.7, 2.2), jumps=(0.3, 4.0), volumes=(1.5e-3, 2e-4),
        conditions=(3e2, 3e3, 3e5), waves=(2, 7), holes=(0.01, 0.22), integers=(3, 6, 33), modes=(3, 5),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Frame:
    """Where the minimiser is and how the axes are turned: u = shear @ (mirrored and permuted (x - minimiser))."""

    minimiser: Floats
    matrix: Floats

    def __call__(self, points: Floats) -> Floats:
        """Coordinates (m, n) about the minimiser. Without BLAS, whose sums depend on the number of rows."""
        return np.asarray(np.einsum("mj,ij->mi", points - self.minimiser, self.matrix))


Kind = Callable[[np.random.Generator, Constants], Landscape]


def landscape(number: int, half: Half) -> Landscape:
    """The landscape of this number in this half; the kind is the number modulo their count."""
    constants, kind = HALVES[half], list(KINDS)[number % len(KINDS)]
    random = np.random.default_rng([constants.salt, number])
    made = KINDS[kind](random, constants)
    scale, shift = 10.0 ** random.uniform(-1.0, 3.0), 10.0 ** random.uniform(-1.0, 3.0) * random.choice([-1.0, 1.0])
    return replace(
        made,
        name=f"{half} {number}: {kind}, {made.dimension} parameters",
        kind=kind,
        minimum=scale * made.minimum + shift,
        target=scale * made.target + shift,
        function=lambda points: scale * made.function(points) + shift,
    )


def frame(random: np.random.Generator, n: int, shear: float, margin: float = 0.1) -> Frame:
    """A random minimiser and axes."""
    matrix = np.eye(n) + shear * np.triu(random.uniform(-1.0, 1.0, (n, n)), 1) / np.sqrt(n)
    turned = np.zeros((n, n))
    turned[np.arange(n), random.permutation(n)] = random.choice([-1.0, 1.0], n)
    return Frame(random.uniform(margin, 1.0 - margin, n), matrix @ turned)


def _made(at: Frame, f: Function, target: float, minimum: float = 0.0, volume: float | None = None) -> Landscape:
    return Landscape("", "", minimum, at.minimiser, target, f, volume)


def peaks(random: np.random.Generator, c: Constants) -> Landscape:
    """Gaussian wells: the deepest is narrow, the others are wider."""
    n, count, width = int(random.choice(c.few)), int(random.choice(c.wells)), float(random.choice(c.widths))
    wells = [frame(random, n, c.shear) for _ in range(count)]
    depths = np.append(1.0, random.uniform(0.4, 0.85, count - 1))
    widths = np.sqrt(n) * np.append(width, random.uniform(1.2, 3.0, count - 1) * width)

    def value(x: Floats) -> Floats:
        found = [
            d * np.exp(-(at(x) ** 2).sum(axis=1) / (2 * w * w)) for at, d, w in zip(wells, depths, widths, strict=True)
        ]
        return np.asarray(-np.max(found, axis=0))

    return _made(wells[0], value, target=-0.95, minimum=-1.0)


def plateaus(random: np.random.Generator, c: Constants) -> Landscape:
    """A bowl cut into steps: constant between them."""
    at, levels = frame(random, int(random.choice(c.dimensions)), c.shear), random.choice(c.levels)
    return _made(at, lambda x: np.floor(levels * np.sqrt((at(x) ** 2).mean(axis=1))) / levels, target=0.5 / levels)


def ridges(random: np.random.Generator, c: Constants) -> Landscape:
    """A sharp ridge, straight or bent, that falls slowly along its length."""
    at = frame(random, int(random.choice(c.dimensions)), c.shear)
    steep, bend = random.choice(c.steepness), random.choice(c.bends)

    def value(x: Floats) -> Floats:
        u = at(x)
        off = u[:, 1:] - bend * u[:, :1] ** 2
        return np.asarray(np.abs(u[:, 0]) + steep * np.sqrt((off**2).sum(axis=1)))

    return _made(at, value, target=0.01)


def cliffs(random: np.random.Generator, c: Constants) -> Landscape:
    """Falls towards the edges of cliffs, in whose corner the lowest point is."""
    n = int(random.choice(c.dimensions))
    at, jump, edges = frame(random, n, c.shear), random.choice(c.jumps), max(1, n // 3)

    def value(x: Floats) -> Floats:
        u = at(x)
        side, rest = u[:, :edges], 4.0 * (u[:, edges:] ** 2).sum(axis=1)
        return np.asarray(np.where(side >= 0.0, side, jump - 0.2 * side).sum(axis=1) + rest)

    return _made(at, value, target=0.01)


def needles(random: np.random.Generator, c: Constants) -> Landscape:
    """A wide bowl, and a box of stated volume elsewhere that is lower; around the box, the bowl is a little lower."""
    n, volume = int(random.choice(c.few)), float(random.choice(c.volumes))
    half_side = 0.5 * volume ** (1.0 / n)
    at = frame(random, n, 0.0, margin=half_side)
    decoy = frame(random, n, c.shear)

    def value(x: Floats) -> Floats:
        inside = np.abs(x - at.minimiser).max(axis=1) / half_side
        bowl = (decoy(x) ** 2).mean(axis=1) - 0.1 * np.maximum(1.0 - inside / 3.0, 0.0)
        return np.asarray(np.where(inside < 1.0, 0.5 * inside - 1.0, bowl))

    return _made(at, value, target=-0.5, minimum=-1.0, volume=volume)


def bowls(random: np.random.Generator, c: Constants) -> Landscape:
    """A quadratic bowl with axes of very different curvature."""
    n, condition = int(random.choice(c.dimensions)), random.choice(c.conditions)
    at, curvature = frame(random, n, 2.0 * c.shear), condition ** np.linspace(0.0, 1.0, n)
    return _made(at, lambda x: np.asarray((curvature * at(x) ** 2).sum(axis=1)), target=1e-6)


def mixed(random: np.random.Generator, c: Constants) -> Landscape:
    """Waves in some directions, jumps in the others, on a bowl."""
    n, waves, levels = int(random.choice(c.dimensions)), random.choice(c.waves), random.choice(c.levels)
    at = frame(random, n, c.shear)

    def value(x: Floats) -> Floats:
        u = at(x)
        smooth, jumping = u[:, : n // 2], u[:, n // 2 :]
        wavy = smooth**2 + 0.2 * (1.0 - np.cos(2 * np.pi * waves * smooth))
        return np.asarray(wavy.sum(axis=1) + (np.floor(levels * np.abs(jumping)) / levels).sum(axis=1))

    return _made(at, value, target=0.01)


def failing(random: np.random.Generator, c: Constants) -> Landscape:
    """A bowl that fails close beyond the minimiser and in balls in the way, and a wider one that is less deep."""
    n = int(random.choice(c.dimensions))
    at, (edge, radius) = frame(random, n, c.shear), c.holes
    if at(np.full((1, n), 0.5))[0, 0] < 0.0:  # the middle of the cube is on the side that does not fail
        at = replace(at, matrix=np.concatenate([-at.matrix[:1], at.matrix[1:]]))
    balls, decoy = random.random((n, n)), random.random(n)
    balls = balls[np.sqrt(((balls - at.minimiser) ** 2).mean(axis=1)) > 1.1 * radius]

    def value(x: Floats) -> Floats:
        u = at(x)
        failed = u[:, 0] < -edge
        for ball in balls:
            failed |= np.sqrt(((x - ball) ** 2).mean(axis=1)) < radius
        deep = np.abs(u[:, 0]) + 4.0 * (u[:, 1:] ** 2).sum(axis=1)
        return np.asarray(np.where(failed, np.nan, np.minimum(deep, 0.1 + 0.3 * ((x - decoy) ** 2).sum(axis=1))))

    return _made(at, value, target=0.01)


def integers(random: np.random.Generator, c: Constants) -> Landscape:
    """A sheared bowl in which every second parameter takes whole numbers only."""
    n, count, condition = int(random.choice(c.dimensions)), int(random.choice(c.integers)), min(c.conditions)
    at, whole = frame(random, n, 3.0 * c.shear), np.arange(0, n, 2)
    curvature = condition ** np.linspace(0.0, 1.0, n)

    def rounded(x: Floats) -> Floats:
        x = x.copy()
        x[:, whole] = (np.minimum(np.floor(x[:, whole] * count), count - 1) + 0.5) / count
        return x

    at = replace(at, minimiser=rounded(at.minimiser[None, :])[0])
    return _made(at, lambda x: np.asarray((curvature * at(rounded(x)) ** 2).sum(axis=1)), target=1e-3)


def switched(random: np.random.Generator, c: Constants) -> Landscape:
    """One parameter chooses among bowls with different minimisers; the steepest is the lowest."""
    n, count = int(random.choice(c.dimensions)), int(random.choice(c.modes))
    bowls_of = [frame(random, n, c.shear) for _ in range(count)]
    switch, best = int(random.integers(n)), int(random.integers(count))
    floors, slopes = random.uniform(0.1, 0.3, count), np.where(np.arange(count) == best, 8.0, 1.0)
    floors[best] = 0.0

    def value(x: Floats) -> Floats:
        mode = np.minimum((x[:, switch] * count).astype(int), count - 1)
        x = x.copy()
        x[:, switch] = 0.0
        found = np.empty(len(x))
        for m, at in enumerate(bowls_of):
            rows = mode == m
            centre = np.where(np.arange(n) == switch, 0.0, at.minimiser)
            found[rows] = floors[m] + slopes[m] * (replace(at, minimiser=centre)(x[rows]) ** 2).sum(axis=1)
        return found

    lowest = bowls_of[best].minimiser.copy()
    lowest[switch] = (best + 0.5) / count
    return _made(replace(bowls_of[best], minimiser=lowest), value, target=1e-3)


KINDS: dict[str, Kind] = {
    "Gaussian peaks": peaks,
    "plateaus": plateaus,
    "ridges": ridges,
    "cliffs": cliffs,
    "needles": needles,
    "ill-conditioned bowls": bowls,
    "smooth and jumping": mixed,
    "failing regions": failing,
    "integer parameters": integers,
    "switched parameters": switched,
}
