"""The joint density of a campaign's uncertain parameters: marginal densities and the Gaussian copula that joins them.

Nelsen, An Introduction to Copulas, 2006, section 2.3. The standard normal space of correlated parameters is that of Der
Kiureghian and Liu, Structural reliability under incomplete probability information, J. Eng. Mech. 112, 1986.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from campaigns import cube, special
from campaigns.asked.distributions import Correlation, Distribution, matrix
from campaigns.asked.spec import Campaign
from campaigns.cube import Floats
from campaigns.densities.shapes import Bell, Shape, shape

Bounds = Mapping[str, tuple[float, float]]
"""Low and high by path, in the parameters' units."""
ROUNDING = 1e-9
"""Fraction of a range by which a value at a bound may be beyond it by conversion of units."""
LEAST, MOST = -37.0, 8.3
"""The scores of the smallest probability, and of the largest below 1: those of a draw that is rounded to a bound."""


@dataclass(frozen=True)
class Joint:
    """shapes: of each parameter by path, in the order of points; mixed: indices of the correlated ones; whitening: the
    matrix that makes their scores independent; by_scores: whether correlated parameters that are not normal are
    compared by these scores alone, as versions before wording 17 did."""

    shapes: dict[str, Shape]
    low: Floats
    high: Floats
    mixed: tuple[int, ...]
    whitening: Floats
    by_scores: bool = False

    @property
    def alone(self) -> list[Shape]:
        """The distributions of the uncorrelated parameters."""
        return [one for k, one in enumerate(self.shapes.values()) if k not in self.mixed]

    @property
    def uniform(self) -> bool:
        """Whether every point of the box is equally likely."""
        return not self.mixed and all(one.freedom == 0 for one in self.alone)

    @property
    def distinguishes(self) -> bool:
        """Whether one point of the box is more likely than another."""
        return not self.uniform and not self.unbounded

    @property
    def unbounded(self) -> list[str]:
        """The uncorrelated parameters whose density has no highest value."""
        alone = self.alone
        return [path for path, one in self.shapes.items() if one in alone and one.peak == math.inf]

    @property
    def skewed(self) -> list[str]:
        """The correlated parameters that are not normal: with them the highest joint density is not known, and their
        scores alone do not show where the density is high."""
        shapes = [] if self.by_scores else list(self.shapes.items())
        mixed = [item for k, item in enumerate(shapes) if k in self.mixed]
        return [path for path, one in mixed if not isinstance(one, Bell) or one.bounded]

    @property
    def outside(self) -> float:
        """The probability of a draw outside the bounds; an upper bound, the sum of the tails, if correlated parameters
        have any."""
        tails = [one.outside for one in self.shapes.values()]
        correlated = any(tails[k] > 0.0 for k in self.mixed)
        return min(1.0, sum(tails)) if correlated else 1.0 - math.prod(1.0 - tail for tail in tails)

    def point(self, values: Mapping[str, float]) -> Floats:
        """Values by path as a point (n,) of the unit cube."""
        return np.clip(cube.share(np.array([values[path] for path in self.shapes]), self.low, self.high), 0.0, 1.0)

    def values(self, points: Floats) -> Floats:
        """Points (m, n) in the parameters' units."""
        return self.low + points * (self.high - self.low)

    def drawn(self, uniform: Floats) -> Floats:
        """Uniform samples (m, n) as draws within the bounds (k, n); those outside are left out."""
        scores = special.normal_quantile(uniform)
        scores[:, self.mixed] = scores[:, self.mixed] @ np.linalg.inv(self.whitening).T
        points = [one.at(scores[:, k]) for k, one in enumerate(self.shapes.values())]
        found = np.stack(points, axis=1)
        return found[((found >= 0.0) & (found <= 1.0)).all(axis=1)]

    def scores(self, points: Floats) -> Floats:
        """The standard normal scores (m, c) of the correlated parameters, not yet independent."""
        shapes = list(self.shapes.values())
        columns = [shapes[k].score(points[:, k]) for k in self.mixed]
        return np.stack(columns, axis=1) if columns else np.empty((len(points), 0))

    def falls(self, points: Floats) -> tuple[Floats, Floats]:
        """How far the density at points (m, n) is below its highest, as `fall`, in two parts (m,).

        Of the uncorrelated parameters in their own units; of the correlated ones, which are normal, in the standard
        normal space. By scores alone it is infinite at a bound.
        """
        free = [k for k in range(len(self.shapes)) if k not in self.mixed]
        own = sum((one.fall(points[:, k]) for k, one in zip(free, self.alone, strict=True)), np.zeros(len(points)))
        scores = self.scores(points)
        known = np.isfinite(scores).all(axis=1)
        joined = np.full(len(points), math.inf)
        joined[known] = ((scores[known] @ self.whitening.T) ** 2).sum(axis=1)
        return own, joined

    def log_density(self, points: Floats) -> Floats:
        """The log density of draws within the bounds (m,), up to a constant if correlated ones have tails outside
        them."""
        return self._log_density(points, np.nan_to_num(self.scores(points), neginf=LEAST, posinf=MOST))

    def ranks(self, points: Floats) -> Floats:
        """A measure (m,) of how high the density at points (m, n) is: more where it is higher, minus infinity where
        nothing is known of it. Both bounds of a correlated parameter have the score of the last float below 1."""
        if not self.skewed:
            own, joined = self.falls(points)
            return -(own + joined)
        with np.errstate(invalid="ignore"):  # the density of one parameter is zero, that of another infinite
            found = self._log_density(points, np.clip(self.scores(points), -MOST, MOST))
        return np.where(np.isnan(found), -math.inf, found)

    def _log_density(self, points: Floats, scores: Floats) -> Floats:
        columns = enumerate(self.shapes.values())
        own = sum((one.log_density(points[:, k]) for k, one in columns), np.zeros(len(points)))
        joined = (scores**2).sum(axis=1) - ((scores @ self.whitening.T) ** 2).sum(axis=1)
        return np.asarray(own + joined / 2.0 + np.linalg.slogdet(self.whitening)[1])

    def rounded(self, values: Floats) -> list[str]:
        """The parameters of which a value (m, n) in its units is at a bound where the density is unbounded: the draws
        there are those that were rounded to it, whose probability is not that of a density."""
        points = np.clip(cube.share(values, self.low, self.high), 0.0, 1.0)
        columns = enumerate(self.shapes.items())
        return [path for k, (path, one) in columns if np.isposinf(one.log_density(points[:, k])).any()]

    def log_density_at(self, values: Floats) -> Floats:
        """The log density (m,) at values (m, n) in the parameters' units, per these; minus infinity outside the
        bounds."""
        points = cube.share(values, self.low, self.high)
        inside = (np.abs(points - 0.5) <= 0.5 + ROUNDING).all(axis=1)
        found = np.full(len(points), -math.inf)
        found[inside] = self.log_density(np.clip(points[inside], 0.0, 1.0)) - np.log(self.high - self.low).sum()
        return found


def joint(campaign: Campaign, bounds: Bounds) -> Joint:
    """The density of a campaign; raises `KeyError` if a parameter has no bounds here."""
    distributions = {path: uncertain.distribution for path, uncertain in campaign.uncertain.items()}
    return joined(distributions, campaign.correlations, bounds)


def joined(distributions: Mapping[str, Distribution], correlations: Sequence[Correlation], bounds: Bounds) -> Joint:
    """The density of these distributions over these bounds, joined by these correlations."""
    paths = list(distributions)
    correlated = {path for c in correlations if c.value != 0.0 for path in c.between}
    mixed = tuple(k for k, path in enumerate(paths) if path in correlated)
    joins = np.array(matrix(correlations, paths))[np.ix_(mixed, mixed)]
    low, high = (np.array([bounds[path][k] for path in paths]) for k in (0, 1))
    shapes = {path: shape(one, *bounds[path]) for path, one in distributions.items()}
    return Joint(shapes, low, high, mixed, np.linalg.inv(np.linalg.cholesky(joins)))
