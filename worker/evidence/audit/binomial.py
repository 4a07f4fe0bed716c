"""Clopper and Pearson's bounds on a probability (Biometrika 26, 1934), computed without the library of the verdict."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def cumulative(most: int, samples: int, p: float) -> Any:
    """The logarithms of P(Binomial(samples, p) <= i) for i = 0 .. most."""
    i = np.arange(most + 1)
    ways = np.concatenate([[0.0], np.cumsum(np.log((samples - i[:-1]) / i[1:]))])
    return np.logaddexp.accumulate(ways + i * math.log(p) + (samples - i) * math.log1p(-p))


def upper_bound(violations: int, samples: int, confidence: float) -> float:
    """The probability p of which P(Binomial(samples, p) <= violations) is 1 - confidence, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60 if violations < samples else 0):
        middle = (low + high) / 2
        above = cumulative(violations, samples, middle)[-1] > math.log1p(-confidence)
        low, high = (middle, high) if above else (low, middle)
    return high


def interval(events: int, samples: int, confidence: float, unknown: int) -> tuple[float, float]:
    """Two-sided; `unknown` samples count as none for the lower end, as events for the upper."""
    one_sided = (1.0 + confidence) / 2
    return 1.0 - upper_bound(samples - events, samples, one_sided), upper_bound(events + unknown, samples, one_sided)
