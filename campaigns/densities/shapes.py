"""The distribution of one parameter as a density over the fractions of its range, within its bounds.

`fall` is how far the density is below its highest value: minus twice the logarithm of their ratio. Of a normal
distribution that is the square of the distance from the mean in standard deviations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from campaigns import special
from campaigns.asked.distributions import Beta, Distribution, Normal, Triangular, TruncatedNormal, Uniform
from campaigns.cube import Floats

FLAT = 1e5
"""A normal distribution whose deviation exceeds this many ranges is uniform to 1e-11 within the bounds."""

LEAST = 1e-150
"""The smallest deviation in ranges, so that squares of distances stay finite."""
GRID = 4097
"""Values between which quantiles are interpolated."""


class Shape:
    """A uniform distribution, and the base of all others."""

    freedom: int | None = 0
    """`fall` of a draw is chi-square with so many degrees of freedom; None if it is not."""
    peak: float = 0.0
    """The logarithm of the highest density; infinite if the density is unbounded."""
    outside: float = 0.0
    """The probability of a draw outside the bounds."""

    def log_density(self, u: Floats) -> Floats:
        """The log density of draws within the bounds."""
        return np.zeros_like(u)

    def below(self, u: Floats) -> Floats:
        """The probability of a value up to u, of draws within the bounds."""
        return u

    def score(self, u: Floats) -> Floats:
        """The standard normal variable behind a value, which a Gaussian copula correlates."""
        return special.normal_quantile(self.below(u))

    def at(self, score: Floats) -> Floats:
        """The value with this score, interpolated: the inverse of `score`."""
        grid = np.linspace(0.0, 1.0, GRID)
        return np.interp(special.normal(score), self.below(grid), grid)

    def fall(self, u: Floats) -> Floats:
        return np.maximum(2.0 * (self.peak - self.log_density(u)), 0.0)

    def beyond(self, q: Floats) -> Floats:
        """The probability that `fall` of a draw is more than q."""
        raise NotImplementedError


@dataclass(frozen=True)
class Flat(Shape):
    """A normal distribution that is so wide that it is uniform within the bounds."""

    outside: float


@dataclass(frozen=True)
class Bell(Shape):
    """A normal distribution of this mean and deviation, in fractions of the range; bounded: cut off at the bounds."""

    mean: float
    deviation: float
    bounded: bool

    @property
    def freedom(self) -> int | None:  # type: ignore[override]
        return None if self.bounded else 1

    @property
    def ends(self) -> tuple[float, float]:
        """The bounds in standard deviations from the mean."""
        return -self.mean / self.deviation, (1.0 - self.mean) / self.deviation

    @property
    def tails(self) -> tuple[float, float]:
        """The probabilities below and above the bounds."""
        low, high = self.ends
        return float(special.normal(low)), float(special.normal(-high))

    @property
    def peak(self) -> float:  # type: ignore[override]
        return -math.log(self.deviation * math.sqrt(2.0 * math.pi) * (1.0 - sum(self.tails)))

    @property
    def outside(self) -> float:  # type: ignore[override]
        return 0.0 if self.bounded else sum(self.tails)

    def log_density(self, u: Floats) -> Floats:
        return self.peak - ((u - self.mean) / self.deviation) ** 2 / 2.0

    def below(self, u: Floats) -> Floats:
        low, high = self.tails
        return np.clip((special.normal((u - self.mean) / self.deviation) - low) / (1.0 - low - high), 0.0, 1.0)

    def score(self, u: Floats) -> Floats:
        return super().score(u) if self.bounded else (u - self.mean) / self.deviation

    def at(self, score: Floats) -> Floats:
        low, high = self.tails
        inside = low + special.normal(score) * (1.0 - low - high)
        return self.mean + self.deviation * (special.normal_quantile(inside) if self.bounded else score)

    def beyond(self, q: Floats) -> Floats:
        tail, (low, high) = special.normal(-np.sqrt(q)), self.tails
        return (np.maximum(tail - low, 0.0) + np.maximum(tail - high, 0.0)) / (1.0 - low - high)


@dataclass(frozen=True)
class Triangle(Shape):
    """A triangle over the range. The square of density over highest density is uniform, so `fall` is exponential."""

    mode: float
    freedom = None
    peak = math.log(2.0)

    def log_density(self, u: Floats) -> Floats:
        left = u / self.mode if self.mode > 0.0 else np.ones_like(u)
        right = (1.0 - u) / (1.0 - self.mode) if self.mode < 1.0 else np.ones_like(u)
        with np.errstate(divide="ignore"):
            return np.asarray(self.peak + np.log(np.where(u < self.mode, left, right)))

    def below(self, u: Floats) -> Floats:
        left = u**2 / self.mode if self.mode > 0.0 else u
        right = 1.0 - (1.0 - u) ** 2 / (1.0 - self.mode) if self.mode < 1.0 else u
        return np.where(u < self.mode, left, right)

    def beyond(self, q: Floats) -> Floats:
        return np.exp(-q)


@dataclass(frozen=True)
class Hump(Shape):
    """A beta distribution over the range."""

    alpha: float
    beta: float
    freedom = None

    @property
    def mode(self) -> float:
        return (self.alpha - 1.0) / (self.alpha + self.beta - 2.0)

    @property
    def peak(self) -> float:  # type: ignore[override]
        bounded = min(self.alpha, self.beta) >= 1.0
        return float(self.log_density(np.array(self.mode))) if bounded else math.inf

    def log_density(self, u: Floats) -> Floats:
        scale = special.log_beta(self.alpha, self.beta)
        return _log_power(u, self.alpha - 1.0) + _log_power(1.0 - u, self.beta - 1.0) - scale

    def below(self, u: Floats) -> Floats:
        return special.beta(u, self.alpha, self.beta)

    def beyond(self, q: Floats) -> Floats:
        left, right = self._level(q, 0.0), self._level(q, 1.0)
        sides = special.beta(left, self.alpha, self.beta) + special.beta(1.0 - right, self.beta, self.alpha)
        return np.where(q > 0.0, sides, 1.0)

    def _level(self, q: Floats, end: float) -> Floats:
        """The point between the mode and this end of the range at which `fall` is q, by bisection; else the end."""
        inner, outer = np.full(q.shape, self.mode), np.full(q.shape, end)
        for _ in range(60):
            middle = (inner + outer) / 2.0
            within = self.fall(middle) <= q
            inner, outer = np.where(within, middle, inner), np.where(within, outer, middle)
        return outer


def _log_power(value: Floats, power: float) -> Floats:
    """The logarithm of value ** power; 1 to the power 0 at 0 as well."""
    if power == 0.0:
        return np.zeros_like(value)
    with np.errstate(divide="ignore"):
        return power * np.log(value)


def shape(distribution: Distribution, low: float, high: float) -> Shape:
    """A distribution of values from low to high."""
    match distribution:
        case Uniform():
            return Shape()
        case Normal() | TruncatedNormal():
            deviation = max(distribution.deviation / (high - low), LEAST)
            mean = (distribution.mean - low) / (high - low)
            bell = Bell(mean, deviation, isinstance(distribution, TruncatedNormal))
            return Flat(bell.outside) if deviation > FLAT else bell
        case Triangular():
            return Triangle(min(max((distribution.mode - low) / (high - low), 0.0), 1.0))
        case Beta():
            flat = distribution.alpha == distribution.beta == 1.0
            return Shape() if flat else Hump(distribution.alpha, distribution.beta)
