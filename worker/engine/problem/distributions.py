"""The distributions of a campaign: maps uniform samples to correlated points of the unit cube.

Correlations are a Gaussian copula: normal samples are correlated by the Cholesky factor and mapped by the quantile
function of each marginal (Nelsen, An Introduction to Copulas, 2006, section 2.3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.distributions import (
    Correlation,
    Distribution,
    Normal,
    Triangular,
    TruncatedNormal,
    Uniform,
    matrix,
)

Floats = NDArray[np.float64]

FLAT = 1e5
"""A normal distribution whose deviation exceeds this many ranges is uniform within the bounds to 1e-11."""

LEAST = 1e-300
"""The smallest probability for which a normal quantile is computed."""


@dataclass(frozen=True)
class Range:
    """One uncertain parameter: path, index in the flat vector, bounds, nominal value and distribution."""

    path: str
    index: int
    low: float
    high: float
    nominal: float
    distribution: Distribution


class Distributions:
    """The joint distribution of a campaign's uncertain parameters."""

    def __init__(self, ranges: Sequence[Range], correlations: Sequence[Correlation] = ()) -> None:
        self.ranges = tuple(ranges)
        paths = [r.path for r in ranges]
        correlated = {path for c in correlations if c.value != 0.0 for path in c.between}
        self.mixed = [k for k, path in enumerate(paths) if path in correlated]
        """Indices of the correlated parameters."""
        self.factor: Floats = np.linalg.cholesky(np.array(matrix(correlations, paths))[np.ix_(self.mixed, self.mixed)])
        beyond = [_beyond(r) for r in ranges]
        self.outside = float(1.0 - np.prod([1.0 - p for p in beyond]))
        """The probability that a draw is outside the bounds; with correlations an upper bound, the sum of the tail
        probabilities (union bound)."""
        if any(beyond[k] > 0.0 for k in self.mixed):
            self.outside = min(1.0, float(sum(beyond)))
        self.redrawn = min(1.0, float(sum(beyond[k] for k in self.mixed)))
        """An upper bound on the probability that `quantile` redraws a value of a draw."""

    @property
    def unbounded(self) -> list[int]:
        """Indices of the correlated normal parameters, whose draws may be beyond the bounds."""
        return [k for k in self.mixed if isinstance(self.ranges[k].distribution, Normal)]

    def quantile(self, uniform: Floats, redrawn: bool = True) -> Floats:
        """Uniform samples (m, n) as points drawn from the campaign's distributions, all within the bounds.

        A value of an unbounded correlated normal that falls outside the bounds is redrawn inside: its position within
        the tail is itself uniform and serves as the new sample. So a point that needed no redraw is exactly the one of
        the unbounded distributions, and the probability of any other point is at most `outside`. With `redrawn` false
        it is put on the bound, which `beyond` shows: an estimate counts no violation there.
        """
        mixed = np.asarray(uniform, dtype=np.float64).copy()
        if self.mixed:
            from scipy import special  # imported late, here and below: a campaign's process must start fast

            normal = special.ndtri(np.clip(mixed[:, self.mixed], LEAST, 1.0 - 2.0**-53)) @ self.factor.T
            for column, k in enumerate(self.mixed):
                mixed[:, k] = _within(self.ranges[k], normal[:, column], redrawn)
        points = self.marginals(mixed)
        for k in () if redrawn else self.unbounded:  # exactly: a quantile of 0 or 1 is rounded
            points[:, k] = np.where((mixed[:, k] <= 0.0) | (mixed[:, k] >= 1.0), mixed[:, k], points[:, k])
        return points

    def beyond(self, points: Floats) -> NDArray[np.bool_]:
        """Which points (m, n) have a correlated normal value on a bound, where `quantile` puts those beyond it."""
        own = points[:, self.unbounded]
        return np.asarray(((own <= 0.0) | (own >= 1.0)).any(axis=1))

    def uniform(self, points: Floats) -> Floats:
        """The inverse of `quantile`: the uniform samples (m, n) of points in which no correlated value was redrawn."""
        uniform = np.empty_like(points)
        for k, r in enumerate(self.ranges):
            uniform[:, k] = _mapped(r, points[:, k], quantile=False)
        if self.mixed:
            from scipy import linalg, special

            shares = [_drawn(self.ranges[k], uniform[:, k]) for k in self.mixed]
            normal = special.ndtri(np.clip(np.stack(shares), LEAST, 1.0 - 2.0**-53))
            uniform[:, self.mixed] = special.ndtr(linalg.solve_triangular(self.factor, normal, lower=True)).T
        return uniform

    def marginals(self, uniform: Floats) -> Floats:
        """The points without correlations: each parameter by its own marginal distribution."""
        points = np.empty_like(uniform)
        for k, r in enumerate(self.ranges):
            points[:, k] = _mapped(r, uniform[:, k], quantile=True)
        return points


def _scaled(r: Range, mean: float, deviation: float) -> tuple[float, float]:
    """Mean and standard deviation as fractions of the range."""
    return (mean - r.low) / (r.high - r.low), deviation / (r.high - r.low)


def _beyond(r: Range) -> float:
    """The probability of a value outside the bounds; unlike SciPy's `ndtr`, also where it is below 2e-308."""
    if not isinstance(r.distribution, Normal):
        return 0.0
    mean, deviation = r.distribution.mean, r.distribution.deviation
    return sum(
        math.erfc(end / math.sqrt(2.0)) / 2.0 for end in ((mean - r.low) / deviation, (r.high - mean) / deviation)
    )


def _within(r: Range, normal: Floats, redrawn: bool) -> Floats:
    """Standard normal samples as uniform samples of the distribution within the bounds; on a bound if not redrawn."""
    from scipy import special

    if not isinstance(r.distribution, Normal):
        return np.asarray(special.ndtr(normal))
    mean, deviation = _scaled(r, r.distribution.mean, r.distribution.deviation)
    low, high = -mean / deviation, (1.0 - mean) / deviation
    below, above = special.ndtr(low), special.ndtr(-high)
    inside = (special.ndtr(normal) - below) / max(1.0 - below - above, LEAST)
    left = np.where(normal < low, special.ndtr(normal) / max(below, LEAST), special.ndtr(-normal) / max(above, LEAST))
    left = left if redrawn else np.where(normal < low, 0.0, 1.0)
    return np.clip(np.where((normal < low) | (normal > high), left, inside), 0.0, 1.0)


def _drawn(r: Range, inside: Floats) -> Floats:
    """The inverse of `_within` for values that were not redrawn, as probabilities of the unbounded distribution."""
    if not isinstance(r.distribution, Normal):
        return inside
    from scipy import special

    mean, deviation = _scaled(r, r.distribution.mean, r.distribution.deviation)
    below, above = special.ndtr(-mean / deviation), special.ndtr((mean - 1.0) / deviation)
    return np.asarray(below + inside * (1.0 - below - above))


def _mapped(r: Range, values: Floats, quantile: bool) -> Floats:
    """Quantiles of one parameter, as fractions of its range; or the inverse: its distribution function there."""
    distribution, which = r.distribution, "ppf" if quantile else "cdf"
    if isinstance(distribution, Uniform):
        return values
    from scipy import special, stats

    if isinstance(distribution, Normal | TruncatedNormal):
        mean, deviation = _scaled(r, distribution.mean, distribution.deviation)
        if deviation > FLAT:  # practically uniform; the tail probabilities would cancel
            return values
        ends = -mean / deviation, (1 - mean) / deviation
        found = getattr(stats.truncnorm, which)(values, *ends, loc=mean, scale=deviation)
    elif isinstance(distribution, Triangular):
        mode = float(np.clip((distribution.mode - r.low) / (r.high - r.low), 0.0, 1.0))
        found = getattr(stats.triang, which)(values, mode)
    else:
        found = (special.betaincinv if quantile else special.betainc)(distribution.alpha, distribution.beta, values)
    mapped = np.asarray(found, dtype=np.float64)
    return np.clip(mapped, 0.0, 1.0) if quantile else mapped
