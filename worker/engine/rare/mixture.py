"""The importance density: per mode one adapted normal and one of unit covariance, and a part of the nominal density.

The adaptation is a cross-entropy step on all draws so far: Kurtz and Song, Cross-entropy-based adaptive importance
sampling using Gaussian mixture (Structural Safety 42, 2013); Geyer, Papaioannou, Straub, Cross entropy-based importance
sampling using Gaussian densities revisited (Structural Safety 76, 2019). The defensive part bounds every weight:
Hesterberg, Weighted average importance sampling and defensive mixture distributions (Technometrics 37, 1995).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from worker.engine.rare.evaluated import Floats

NOMINAL, UNIT = 0.1, 0.15
"""Parts of the nominal density, and of the normals of unit covariance at the design points."""
LEAST_SHARE = 0.3
"""Of an even division among the modes: what a mode is drawn at least."""
WIDER = 1.2
"""The adapted covariances are drawn wider by this factor: what they miss has large weights."""
NEARER = 0.97
"""A violation that is so much nearer to the origin than the design point of its mode takes its place."""
CENTRE_WEIGHT = 5.0
"""Draws that the centre expected of a half-space counts as; its covariance counts as the dimension and five."""


@dataclass(frozen=True)
class Mixture:
    """designs (k, n), and per mode the adapted centre (k, n), covariance (k, n, n) and share (k,)."""

    designs: Floats
    centres: Floats
    covariances: Floats
    shares: Floats

    @staticmethod
    def of(designs: Floats) -> Mixture:
        """The mixture as if every mode were the half-space beyond the tangent at its design point."""
        from scipy import special

        centres, covariances = zip(*(_half_space(point) for point in designs), strict=True)
        likely = special.log_ndtr(-np.linalg.norm(designs, axis=1))
        return Mixture(designs, np.array(centres), np.array(covariances), special.softmax(likely))

    @property
    def parts(self) -> Floats:
        """The probabilities of the components: nominal, adapted ones, unit ones."""
        even = 1.0 / len(self.shares)
        shares = LEAST_SHARE * even + (1.0 - LEAST_SHARE) * self.shares
        return np.concatenate([[NOMINAL], (1.0 - NOMINAL - UNIT) * shares, UNIT * shares])

    def draws(self, random: np.random.Generator, count: int) -> Floats:
        """Independent draws (count, n)."""
        which = random.choice(len(self.parts), count, p=self.parts)
        unit = random.standard_normal((count, self.designs.shape[1]))
        points = unit.copy()
        for k, (centre, covariance) in enumerate(zip(self.centres, self.covariances, strict=True)):
            own = which == 1 + k
            points[own] = centre + unit[own] @ np.linalg.cholesky(WIDER * covariance).T
            own = which == 1 + len(self.centres) + k
            points[own] = self.designs[k] + unit[own]
        return points

    def log_components(self, points: Floats) -> Floats:
        """Log densities (m, 1 + 2 k) of the components, relative to the nominal density."""
        square = np.sum(points**2, axis=1)
        adapted = [_log_normal(points, c, WIDER * s) for c, s in zip(self.centres, self.covariances, strict=True)]
        unit = [-np.sum((points - d) ** 2, axis=1) / 2.0 for d in self.designs]
        return np.column_stack([np.zeros(len(points)), *(part + square / 2.0 for part in (*adapted, *unit))])

    def log_ratio(self, points: Floats) -> Floats:
        """The log of the density (m,) relative to the nominal one: minus the log of the weights."""
        from scipy import special

        return np.asarray(special.logsumexp(self.log_components(points) + np.log(self.parts), axis=1))

    def responsible(self, points: Floats) -> Floats:
        """The probability (m, k) that a violation is of each mode."""
        from scipy import special

        k = len(self.shares)
        both = self.log_components(points)[:, 1:] + np.log(self.parts[1:])
        return np.asarray(special.softmax(np.logaddexp(both[:, :k], both[:, k:]), axis=1))

    def adapted(self, points: Floats, weights: Floats) -> Mixture:
        """A cross-entropy step: fitted to weighted violations, towards the half-spaces where they are few."""
        if not len(points):
            return self
        start = Mixture.of(self._nearer(points))
        n = points.shape[1]
        by_mode = self.responsible(points) * (weights / weights.sum())[:, None]
        totals = by_mode.sum(axis=0)
        effective = totals**2 / np.maximum(np.sum(by_mode**2, axis=0), 1e-300)
        centres, covariances = start.centres.copy(), start.covariances.copy()
        for k in np.flatnonzero(effective > 2.0):
            own = by_mode[:, k] / totals[k]
            mean = own @ points
            e = effective[k]
            centres[k] = (e * mean + CENTRE_WEIGHT * start.centres[k]) / (e + CENTRE_WEIGHT)
            apart = points - centres[k]
            prior = n + 5.0
            covariances[k] = (e * (apart.T * own) @ apart + prior * start.covariances[k]) / (e + prior)
        return replace(start, centres=centres, covariances=covariances, shares=totals / totals.sum())

    def _nearer(self, points: Floats) -> Floats:
        """The designs, or a more likely violation of their mode: without slopes a descent ends before the limit."""
        designs, lengths = self.designs.copy(), np.linalg.norm(points, axis=1)
        modes = self.responsible(points).argmax(axis=1)
        for k in range(len(designs)):
            own = np.flatnonzero(modes == k)
            if len(own) and lengths[nearest := own[lengths[own].argmin()]] < NEARER * np.linalg.norm(designs[k]):
                designs[k] = points[nearest]
        return designs


def _half_space(design: Floats) -> tuple[Floats, Floats]:
    """Mean and covariance of the standard normal beyond the tangent plane; wider along the normal, for safety."""
    from scipy import special

    length = float(np.linalg.norm(design))
    if length < 1e-6:
        return design, np.eye(len(design))
    normal = design / length
    mean = float(np.exp(-(length**2) / 2.0 - special.log_ndtr(-length)) / np.sqrt(2.0 * np.pi))
    variance = 1.5 * (1.0 + length * mean - mean**2)
    return mean * normal, np.eye(len(design)) - (1.0 - variance) * np.outer(normal, normal)


def _log_normal(points: Floats, centre: Floats, covariance: Floats) -> Floats:
    """The log density without the factor of 2 pi, which the nominal one has too."""
    factor = np.linalg.cholesky(covariance)
    unit = np.linalg.solve(factor, (points - centre).T)
    return np.asarray(-np.sum(unit**2, axis=0) / 2.0 - np.sum(np.log(np.diag(factor))))
