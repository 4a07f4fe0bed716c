"""Gaussian process of a few hundred points of the unit cube: fit, posterior mean, and joint samples of the posterior.

Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), chapters 2 and 5: Matern 5/2 with a length scale
for each parameter, constant mean 0 of standardised values, hyperparameters by maximum marginal likelihood (L-BFGS-B).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from worker.engine.search.base import Floats
from worker.engine.search.parts.one_thread import one_thread

# Bounds as in the program of Eriksson et al. (2019): length scales in fractions of the ranges, variances in those of
# the standardised values.
LENGTHS, SIGNAL, NOISE = (0.005, 2.0), (0.05, 20.0), (5e-4, 0.2)
FIRST = (0.5, 1.0, 5e-3)
JITTER = 1e-6
"""Added to the diagonal of a posterior covariance, which is singular where points are close."""
STEPS = 50
"""Iterations of a fit at most; Eriksson et al. take as many steps of Adam."""


@dataclass(frozen=True)
class Process:
    """A fitted process: points (m, n), length scales (n,), variances, and K^-1 y with the factor L of K = L L^T."""

    points: Floats
    lengths: Floats
    signal: float
    noise: float
    centre: float
    scale: float
    factor: Floats
    weights: Floats

    def posterior(self, at: Floats) -> tuple[Floats, Floats]:
        """Mean (p,) and covariance (p, p) of the function at points (p, n), equations 2.25 and 2.26."""
        from scipy.linalg import solve_triangular  # imported late, here and below: a campaign's process must start fast

        with one_thread():
            cross = self.signal * _matern(_distances(at / self.lengths, self.points / self.lengths))
            mean = self.centre + self.scale * (cross @ self.weights)
            half = solve_triangular(self.factor, cross.T, lower=True, check_finite=False)
            prior = self.signal * _matern(_distances(at / self.lengths, at / self.lengths))
            return mean, self.scale**2 * (prior - half.T @ half)

    def sampled(self, at: Floats, count: int, random: np.random.Generator) -> Floats:
        """`count` joint samples (count, p) of the function at points (p, n), equation A.2."""
        mean, covariance = self.posterior(at)
        drawn = random.standard_normal((count, len(at)))
        scale = max(float(np.abs(np.diag(covariance)).max()), np.finfo(float).tiny)
        with one_thread():
            return mean + drawn @ _factor(covariance / scale, JITTER).T * math.sqrt(scale)


def fitted(points: Floats, values: Floats, before: Process | None = None) -> Process:
    """The process of values (m,) at points (m, n); the fit begins at the hyperparameters of an earlier one."""
    from scipy.linalg import cho_solve
    from scipy.optimize import minimize

    centre, scale = float(np.median(values)), float(np.std(values))
    scale = scale if np.isfinite(scale) and scale > 1e-12 * max(1.0, abs(centre)) else 1.0
    y = (values - centre) / scale
    n = points.shape[1]
    low, high = (np.log([LENGTHS[k]] * n + [SIGNAL[k], NOISE[k]]) for k in (0, 1))
    guess = np.log([FIRST[0]] * n + [FIRST[1], FIRST[2]])
    if before is not None:
        guess = np.clip(np.log([*before.lengths, before.signal, before.noise]), low, high)
    with one_thread():
        if len(points) > 1:
            negative: Any = lambda theta: _likelihood(theta, points, y)  # noqa: E731
            found = minimize(
                negative,
                guess,
                method="L-BFGS-B",
                jac=True,
                bounds=list(zip(low.tolist(), high.tolist(), strict=True)),
                options={"maxiter": STEPS},
            )
            guess = np.clip(found.x, low, high)
        lengths, signal, noise = np.exp(guess[:n]), math.exp(guess[n]), math.exp(guess[n + 1])
        covariance = signal * _matern(_distances(points / lengths, points / lengths))
        factor = _factor(covariance + noise * np.eye(len(points)), 0.0)
        weights = cho_solve((factor, True), y, check_finite=False)
    return Process(points.copy(), lengths, signal, noise, centre, scale, factor, weights)


def _likelihood(theta: Floats, points: Floats, y: Floats) -> tuple[float, Floats]:
    """Minus the log marginal likelihood over m, and its gradient, equations 5.8 and 5.9."""
    from scipy.linalg import cho_solve
    from scipy.linalg.lapack import dpotri

    n, m = points.shape[1], len(points)
    lengths, signal, noise = np.exp(theta[:n]), math.exp(theta[n]), math.exp(theta[n + 1])
    scaled = points / lengths
    r = math.sqrt(5.0) * _distances(scaled, scaled)
    decay = np.exp(-r)
    correlation = (1.0 + r + r * r / 3.0) * decay
    covariance = signal * correlation
    covariance[np.diag_indices(m)] += noise
    factor = _factor(covariance, 0.0)
    alpha = cho_solve((factor, True), y, check_finite=False)
    lower = np.tril(dpotri(factor, lower=1)[0])
    outer = lower + np.tril(lower, -1).T - np.outer(alpha, alpha)  # K^-1 - alpha alpha^T
    pull = outer * (signal * (5.0 / 3.0)) * (1.0 + r) * decay
    # The sum of pull_ab (x_a - x_b)^2 over all pairs, without forming the differences.
    by_length = (pull.sum(axis=1) @ scaled**2) - np.einsum("ai,ai->i", scaled, pull @ scaled)
    gradient = np.concatenate(
        [by_length, [0.5 * signal * float((outer * correlation).sum()), 0.5 * noise * float(np.trace(outer))]]
    )
    value = 0.5 * float(y @ alpha) + float(np.log(np.diag(factor)).sum())
    return value / m, gradient / m


def _distances(a: Floats, b: Floats) -> Floats:
    """Euclidean distances (p, q) of points (p, n) and (q, n)."""
    squares = a @ b.T
    squares *= -2.0
    squares += (a**2).sum(axis=1)[:, None]
    squares += (b**2).sum(axis=1)
    np.maximum(squares, 0.0, out=squares)
    return np.asarray(np.sqrt(squares, out=squares))


def _matern(distances: Floats) -> Floats:
    """Equation 4.17 for nu = 5/2, of distances in length scales: (1 + r + r^2 / 3) exp(-r), r = sqrt(5) d."""
    r = math.sqrt(5.0) * distances
    value = r / 3.0
    value += 1.0
    value *= r
    value += 1.0
    np.negative(r, out=r)
    value *= np.exp(r, out=r)
    return value


def _factor(matrix: Floats, jitter: float) -> Floats:
    """The lower Cholesky factor; the diagonal is raised until there is one."""
    from scipy.linalg import LinAlgError, cholesky

    while True:
        try:
            raised = matrix + jitter * np.eye(len(matrix)) if jitter else matrix
            return np.asarray(cholesky(raised, lower=True, check_finite=False))
        except LinAlgError:
            jitter = max(10.0 * jitter, 1e-8)
            if not jitter < 1.0:
                raise
