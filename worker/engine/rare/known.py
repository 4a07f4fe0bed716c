"""The modes that are known: their design points, what they explain, and how often a search reached each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare.evaluated import Allowance, Asking, Bools, Floats, evaluated

ON_THE_WAY = np.array([0.2, 0.4, 0.6, 0.8])
"""Where the segment between two violations of one mode must violate, too."""


@dataclass
class Known:
    """Design points and slopes of the limit state there (k, n), how many descents of the search reached each (k,), and
    the numbers of the violations that led to it: None where the search found it."""

    designs: Floats
    slopes: Floats
    reached: NDArray[np.int64]
    origins: list[list[int] | None]

    @staticmethod
    def none(dimension: int) -> Known:
        empty = np.empty((0, dimension))
        return Known(empty, empty, np.empty(0, dtype=np.int64), [])

    def explains(self, points: Floats) -> Bools:
        """Whether points (m, n) are beyond the tangent plane of a known design point."""
        squares = np.sum(self.designs**2, axis=1)
        return np.asarray((points @ self.designs.T >= squares).any(axis=1))

    def cosines(self, points: Floats) -> Floats:
        """The cosines (m, k) of the angles between points and design points."""
        lengths = np.outer(np.linalg.norm(points, axis=1), np.linalg.norm(self.designs, axis=1))
        return np.asarray(points @ self.designs.T / np.maximum(lengths, 1e-12))

    def expected(self, points: Floats) -> Floats:
        """The margins (m,) of points by the linearised limit states."""
        return np.asarray(np.min(points @ self.slopes.T - np.sum(self.designs * self.slopes, axis=1), axis=1))

    def of_mode(self, point: Floats, allowed: Allowance) -> Asking[int | None]:
        """The mode of a violation: that of the nearest direction, if the segment to its design point violates."""
        if not len(self.designs):
            return None
        k = int(self.cosines(point[None])[0].argmax())
        seen = yield from evaluated(point + ON_THE_WAY[:, None] * (self.designs[k] - point), allowed)
        return k if seen.violates.all() else None

    def add(self, points: Floats, slopes: Floats, origins: list[int] | None, allowed: Allowance) -> Asking[None]:
        """Adds design points, those of a known mode to it; origins: the violations they come from, None in a search."""
        for i in np.argsort(np.linalg.norm(points, axis=1)):
            k = yield from self.of_mode(points[i], allowed)
            if k is None:
                k = len(self.designs)
                self.designs, self.slopes = np.vstack([self.designs, points[i]]), np.vstack([self.slopes, slopes[i]])
                self.reached = np.append(self.reached, 0)
                self.origins.append(None if origins is None else [])
            elif np.linalg.norm(points[i]) < np.linalg.norm(self.designs[k]):
                self.designs[k], self.slopes[k] = points[i], slopes[i]
            own = self.origins[k]
            if origins is None:
                self.reached[k] += 1
            elif own is not None:
                own.append(origins[i])
