"""Where rays from the trim leave a region {V < 1}: its volume, and its sections by two states."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from campaigns.certificates.polynomials import Polynomial
from campaigns.cube import Floats as Floats

FARTHEST, POINTS, HALVINGS = 100.0, 400, 45


def directions(n: int, count: int) -> Floats:
    """Unit vectors (count, n): evenly spaced in the plane, else random ones, always the same."""
    if n == 2:
        angle = np.arange(count) * (2.0 * np.pi / count)
        return np.column_stack([np.cos(angle), np.sin(angle)])
    drawn = np.random.default_rng(0).standard_normal((count, n))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def along_rays(v: Polynomial, rays: Floats) -> Floats:
    """The coefficients of v on each ray by powers of the distance (count, degree + 1)."""
    found = np.zeros((len(rays), 1 + max(map(sum, v))))
    for m, c in v.items():
        found[:, sum(m)] += float(c) * np.prod(rays ** np.array(m), axis=1)
    return found


def radii(v: Polynomial, rays: Floats) -> Floats:
    """The least distance along each ray at which V = 1; infinite where there is none."""
    powers = along_rays(v, rays)

    def outside(r: Floats) -> Any:
        return sum(powers[:, k, None] * r**k for k in range(powers.shape[1])) >= 1.0

    size = float(np.median(np.linalg.norm(rays, axis=1)))
    grid = np.geomspace(1e-3, FARTHEST, POINTS) / size
    beyond = outside(np.broadcast_to(grid, (len(rays), POINTS)))
    first = beyond.argmax(axis=1)
    low, high = np.where(first > 0, grid[first - 1], 0.0), grid[first]
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        left = outside(middle[:, None])[:, 0]
        low, high = np.where(left, low, middle), np.where(left, middle, high)
    return np.where(beyond.any(axis=1), low, np.inf)


def volume(distances: Floats, n: int) -> float:
    """The volume of the region whose boundary has these distances along uniformly distributed rays."""
    ball = math.pi ** (n / 2.0) / math.gamma(n / 2.0 + 1.0)
    return float(ball * np.mean(distances**n))


ANGLES, EVERY = 72, 3
"""Angles of the boundary of a section; every so manieth is simulated."""
COUNT = 100
"""Rays that measure volumes in more than two dimensions; in the plane they are the angles."""


def all_around(n: int) -> Floats:
    """The rays that measure volumes."""
    return directions(n, ANGLES if n == 2 else COUNT)


class Drawn(NamedTuple):
    """A region {V(y) < 1}, x = T y, as it is drawn and measured."""

    certified: Floats
    """Its radii along `all_around`, in y."""
    reach: list[float]
    """How far it reaches along the axis of each state."""
    sections: dict[tuple[int, int], Floats]
    """By two states: its radii in their plane, where each state is relative to its reach."""


def drawn(v: Polynomial, matrix: list[list[Fraction]]) -> Drawn:
    """The numbers of a region."""
    n = len(matrix)
    inverse = np.linalg.inv(np.array([[float(c) for c in row] for row in matrix]))
    reach = radii(v, inverse.T)
    angles = directions(2, ANGLES)
    sections = {}
    for i, k in itertools.combinations(range(n), 2):
        plane = np.zeros((ANGLES, n))
        plane[:, [i, k]] = angles * reach[[i, k]]
        sections[i, k] = radii(v, plane @ inverse.T)
    return Drawn(radii(v, all_around(n)), reach.tolist(), sections)


INSIDE = 0.999
"""Of a certified radius: up to there a simulation must return."""


def contradicting(certified: Floats, simulated: Floats) -> int:
    """Rays on which a simulation did not return from inside the region."""
    return int(np.count_nonzero(simulated < certified * INSIDE * (1.0 - 1e-9)))


def fraction(certified: Floats, simulated: Floats, n: int) -> float | None:
    """The volume of a region relative to that of the simulated one; None where that one has no end."""
    return volume(certified, n) / volume(simulated, n) if np.isfinite(simulated).all() else None
