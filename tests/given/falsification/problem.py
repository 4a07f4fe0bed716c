"""What a falsification problem is, and the operators of signal temporal logic over sampled signals.

Robustness as in Fainekos and Pappas (2009): a number whose sign states whether the requirement holds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from worker.engine.search.base import Floats

Simulate = Callable[[Floats], Floats]
"""Signals (samples, k) at regular times, from one row of inputs in their units."""


@dataclass(frozen=True)
class Falsification:
    """A requirement on a system; called with points (m, n) of the unit cube, it gives its robustness (m,).

    ranges: (low, high) of each input. NaN: the simulation left the validity of the model.
    """

    name: str
    requirement: str
    ranges: tuple[tuple[float, float], ...]
    simulate: Simulate
    robustness: Callable[[Floats], float]

    def __call__(self, points: Floats) -> Floats:
        """Robustness (m,) at points (m, n)."""
        low, high = np.array(self.ranges).T
        return np.array([self.robustness(self.simulate(row)) for row in low + points * (high - low)])

    @property
    def dimension(self) -> int:
        return len(self.ranges)


def always(signal: Floats, first: int, last: int) -> Floats:
    """The robustness of "always" within so many samples from each one on; shorter by `last`."""
    return np.asarray(_windows(signal, first, last).min(axis=1))


def eventually(signal: Floats, first: int, last: int) -> Floats:
    """The robustness of "eventually" within so many samples from each one on; shorter by `last`."""
    return np.asarray(_windows(signal, first, last).max(axis=1))


def _windows(signal: Floats, first: int, last: int) -> Floats:
    return np.lib.stride_tricks.sliding_window_view(signal[first:], last - first + 1)
