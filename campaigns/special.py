"""The distribution functions of the normal, chi-square and beta distributions, without SciPy.

Beta: the continued fraction of Press et al., Numerical Recipes, 3rd ed. 2007, section 6.4. Chi-square: the finite sums
for whole degrees of freedom (Abramowitz and Stegun, 26.4.4 and 26.4.5).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from campaigns.cube import Floats

_STANDARD = NormalDist()
_TINY, _ACCURATE, _STEPS = 1e-300, 1e-15, 10_000


def _each(function: Callable[[float], float], values: ArrayLike) -> Floats:
    """What a function of one number gives for each; `np.vectorize` takes half as long again."""
    arguments = np.asarray(values, dtype=np.float64)
    return np.fromiter(map(function, arguments.ravel().tolist()), np.float64, arguments.size).reshape(arguments.shape)


def normal(z: ArrayLike) -> Floats:
    """P(Z <= z)."""
    return np.asarray(_each(math.erfc, -np.asarray(z, dtype=np.float64) / math.sqrt(2.0)) / 2.0)


def normal_quantile(p: ArrayLike) -> Floats:
    """z of P(Z <= z) = p; infinite at 0 and 1."""
    probabilities = np.asarray(p, dtype=np.float64)
    found, inside = np.array(np.copysign(np.inf, probabilities - 0.5)), (probabilities > 0.0) & (probabilities < 1.0)
    found[inside] = _each(_STANDARD.inv_cdf, probabilities[inside])
    return found


def chi_square_beyond(q: ArrayLike, freedom: int) -> Floats:
    """P(chi-square > q) for a whole number of degrees of freedom; without any, whether q is negative."""
    return _each(lambda v: _beyond(v, freedom), q)


def _beyond(q: float, freedom: int) -> float:
    if freedom == 0 or q <= 0.0:
        return float(q <= 0.0)
    half, odd = q / 2.0, freedom % 2
    total, term = (math.erfc(math.sqrt(half)), math.sqrt(half / math.pi) * 2.0) if odd else (0.0, 1.0)
    sums = 0.0
    for k in range(freedom // 2):
        sums += term
        term *= half / (k + (1.5 if odd else 1.0))
    return total + math.exp(-half) * sums


def beta(x: ArrayLike, a: float, b: float) -> Floats:
    """P(X <= x) of the beta distribution with the shapes a and b: the regularised incomplete beta function."""
    return _each(lambda v: _beta(v, a, b), x)


def _beta(x: float, a: float, b: float) -> float:
    if x <= 0.0 or x >= 1.0:
        return float(x >= 1.0)
    front = math.exp(a * math.log(x) + b * math.log1p(-x) - log_beta(a, b))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * _fraction(x, a, b) / a
    return 1.0 - front * _fraction(1.0 - x, b, a) / b


def log_beta(a: float, b: float) -> float:
    """The logarithm of the beta function."""
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)


def _fraction(x: float, a: float, b: float) -> float:
    """The continued fraction, by Lentz' method."""
    c, d = 1.0, 1.0 / _away(1.0 - (a + b) * x / (a + 1.0))
    h = d
    for m in range(1, _STEPS):
        for term in (
            m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0)),
        ):
            d, c = 1.0 / _away(1.0 + term * d), _away(1.0 + term / c)
            h *= d * c
        if abs(d * c - 1.0) < _ACCURATE:
            break
    return h


def _away(value: float) -> float:
    return value if abs(value) > _TINY else _TINY


def beta_quantile(p: float, a: float, b: float) -> float:
    """x of P(X <= x) = p, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if _beta(middle, a, b) < p else (low, middle)
    return (low + high) / 2.0
