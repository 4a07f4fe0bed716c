"""Clopper and Pearson's bounds on a probability (Biometrika 26, 1934), computed without the library of the verdict."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

FAR = 40.0
"""Standard deviations below the mean from which on no event is added: their probability is below 1e-300."""


def least(samples: int, p: float) -> int:
    """The fewest events of which the probability is a number."""
    return max(0, math.floor(samples * p - FAR * (1.0 + math.sqrt(samples * p * (1.0 - p)))))


def cumulative(most: int, samples: int, p: float, first: int = 0) -> Any:
    """The logarithms of P(first <= Binomial(samples, p) <= i) for i = first .. most."""
    i = np.arange(first, most + 1)
    more = np.log((samples - i[:-1]) / i[1:]) + (math.log(p) - math.log1p(-p))
    return np.logaddexp.accumulate(_log_chance(first, samples, p) + np.concatenate([[0.0], np.cumsum(more)]))


def _log_chance(events: int, samples: int, p: float) -> float:
    """The logarithm of P(Binomial(samples, p) = events), by the saddle point (Loader, Fast and accurate computation of
    binomial probabilities, 2000): differences of the logarithms of large factorials lose what they have in common."""
    if events in (0, samples):
        return samples * (math.log1p(-p) if events == 0 else math.log(p))
    others = samples - events
    apart = _deviance(events, samples * p) + _deviance(others, samples * (1.0 - p))
    beyond = _beyond_stirling(samples) - _beyond_stirling(events) - _beyond_stirling(others)
    return beyond - apart + 0.5 * math.log(samples / (2.0 * math.pi * events * others))


def _deviance(x: float, mean: float) -> float:
    """x log(x / mean) + mean - x."""
    t = (x - mean) / mean
    if abs(t) > 0.01:
        return x * math.log(x / mean) + mean - x
    return float(mean * sum((-t) ** k / (k * (k - 1)) for k in range(2, 12)))


def _beyond_stirling(n: int) -> float:
    """log n! without its Stirling approximation."""
    if n < 16:
        return math.lgamma(n + 1) - (n + 0.5) * math.log(n) + n - 0.5 * math.log(2.0 * math.pi)
    return 1 / (12 * n) - 1 / (360 * n**3) + 1 / (1260 * n**5) - 1 / (1680 * n**7)


def upper_bound(violations: int, samples: int, confidence: float) -> float:
    """The probability p of which P(Binomial(samples, p) <= violations) is 1 - confidence, by bisection."""
    if violations >= samples:
        return 1.0
    low, high = violations / samples, 1.0  # that of half or more is never below the fraction seen
    first = least(samples, low)
    for _ in range(60):
        middle = (low + high) / 2
        above = cumulative(violations, samples, middle, first)[-1] > math.log1p(-confidence)
        low, high = (middle, high) if above else (low, middle)
    return high


def interval(events: int, samples: int, confidence: float, unknown: int) -> tuple[float, float]:
    """Two-sided; `unknown` samples count as none for the lower end, as events for the upper."""
    one_sided = (1.0 + confidence) / 2
    return 1.0 - upper_bound(samples - events, samples, one_sided), upper_bound(events + unknown, samples, one_sided)
