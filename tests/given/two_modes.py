"""Toys with two modes of nearly equal depth, well apart, of equal or unequal widths: both are worst cases to report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.function.result import Result
from clearance.function.search import search
from worker.engine.search.base import Floats

THRESHOLD = 0.5
"""Of the margin: both modes violate it, nominal does not."""
WIDTHS = {"equal": (0.15, 0.15), "unequal": (0.25, 0.12)}
"""Deviations of the two Gaussian wells; the narrower one is less deep, so the lowest evaluations do not show it. In 5
parameters a search of two seeds of 30 never comes near a well of 0.08, which a random sample may or may not meet."""


@dataclass(frozen=True)
class TwoModes:
    """A margin over the unit cube with wells of depth 1 and 0.97 at `places` (2, n)."""

    places: Floats
    widths: tuple[float, float]

    @staticmethod
    def drawn(dimension: int, widths: str, seed: int) -> TwoModes:
        """Places that are drawn by the seed, on different sides of the middle along every parameter."""
        random = np.random.default_rng([dimension, seed])
        side = random.choice([-1.0, 1.0], dimension)
        return TwoModes(
            0.5 + np.array([[1.0], [-1.0]]) * side * random.uniform(0.2, 0.35, (2, dimension)), WIDTHS[widths]
        )

    @property
    def names(self) -> list[str]:
        return [f"x{k}" for k in range(self.places.shape[1])]

    def __call__(self, **values: Floats) -> Floats:
        points = np.stack([np.asarray(values[name]) for name in self.names], axis=-1)
        squares = ((points[..., None, :] - self.places) ** 2).sum(axis=-1)
        wells = np.array([1.0, 0.97]) * np.exp(-0.5 * squares / np.array(self.widths) ** 2)
        return np.asarray(1.0 - wells.max(axis=-1))

    def found(self, seed: int) -> tuple[list[bool], Result]:
        """Whether each mode is a finding of a search with nothing chosen, and its result."""
        ranges = dict.fromkeys(self.names, (0.0, 1.0))
        result = search(self.__call__, ranges, THRESHOLD, vectorized=True, seed=seed, sample_seed=seed)
        points = np.array([[f.parameters[name] for name in self.names] for f in result.findings])
        return [bool((np.abs(points - place).max(axis=1) < 0.01).any()) for place in self.places], result
