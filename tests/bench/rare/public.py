"""22 public problems of rare failure, written from their formulas, with published and recomputed probabilities.

RP: the repository of reliability problems of the TNO challenge (Rozsas and Slobbe 2019,
rprepo.readthedocs.io/en/latest/reliability_problems.html), as otbenchmark states them (Fekhari, Baudin et al. 2021,
github.com/openturns/otbenchmark), whose probabilities are the published ones here. Of its 26 problems, RP55 (P = 0.56),
RP63 (100 parameters), R-S and the stressed beam (a line in two parameters, P > 0.02) are left out.
The published probabilities of RP60, RP107, RP111 and RP77 differ from the recomputed ones, which judge, by +1.7 %,
+1.9 %, -4.8 % and +6.7 %; all others by less than 0.8 %.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sqrt

import numpy as np
from scipy import special

from tests.bench.rare.problem import Floats, Problem

Marginal = Callable[[Floats], Floats]


def normal(mean: float, deviation: float) -> Marginal:
    return lambda u: mean + deviation * u


def lognormal(mean: float, deviation: float) -> Marginal:
    spread = sqrt(np.log1p((deviation / mean) ** 2))
    return lambda u: np.exp(np.log(mean) - spread**2 / 2 + spread * u)


def gumbel(mean: float, deviation: float) -> Marginal:
    scale = deviation * sqrt(6.0) / pi
    return lambda u: mean - np.euler_gamma * scale - scale * np.log(-special.log_ndtr(u))


def uniform(low: float, high: float) -> Marginal:
    return lambda u: low + (high - low) * special.ndtr(u)


def exponential(u: Floats) -> Floats:
    return np.asarray(-special.log_ndtr(-u))


STANDARD = normal(0.0, 1.0)


def four_branches(x: Floats, y: Floats) -> Floats:
    bent, along, across = 3.0 + 0.1 * (x - y) ** 2, (x + y) / sqrt(2.0), x - y
    return np.min([bent - along, bent + along, across + 7.0 / sqrt(2.0), 7.0 / sqrt(2.0) - across], axis=0)


def rp14(x1: Floats, x2: Floats, x3: Floats, x4: Floats, x5: Floats) -> Floats:
    return np.asarray(x1 - 32.0 / (pi * x2**3) * np.sqrt(x3**2 * x4**2 / 16.0 + x5**2))


def rp35(x: Floats, y: Floats) -> Floats:
    return np.minimum(2.0 - y + np.exp(-0.1 * x**2) + (0.2 * x) ** 4, 4.5 - x * y)


def rp38(x1: Floats, x2: Floats, x3: Floats, x4: Floats, x5: Floats, x6: Floats, x7: Floats) -> Floats:
    above = x4**2 - 4.0 * x5 * x6 * x7**2 + x4 * (x6 + 4.0 * x5 + 2.0 * x6 * x7)
    return np.asarray(15.59e4 - x1 * x2**3 / (2.0 * x3**3) * above / (x4 * x5 * (x4 + x6 + 2.0 * x6 * x7)))


def rp57(x: Floats, y: Floats) -> Floats:
    return np.minimum(np.maximum(-(x**2) + y**3 + 3.0, 2.0 - x - 8.0 * y), (x + 3.0) ** 2 + (y + 3.0) ** 2 - 4.0)


def rp60(x1: Floats, x2: Floats, x3: Floats, x4: Floats, x5: Floats) -> Floats:
    one_of = np.maximum(x4 - x5, np.minimum(x2 - x5, x3 - x5))
    return np.minimum(x1 - x5, np.maximum(np.min([x2, x3, x4], axis=0) - x5 / 2.0, one_of))


def rp91(x1: Floats, x2: Floats, x3: Floats, x4: Floats, x5: Floats) -> Floats:
    linear = 0.847 + 0.96 * x2 + 0.986 * x3 - 0.216 * x4
    squares = 0.077 * x2**2 + 0.11 * x3**2 + 7.0 / 378.0 * x4**2
    first = linear + squares - x3 * x2 - 0.106 * x2 * x4 - 0.11 * x3 * x4
    second = 84000.0 * x1 / np.sqrt(x3**2 + x4**2 - x3 * x4 + 3.0 * x5**2) - 1.0
    return np.min([first, second, 84000.0 * x1 / np.abs(x4) - 1.0], axis=0)


def rp110(x: Floats, y: Floats) -> Floats:
    return np.minimum(np.where(x <= 3.5, 0.85 - 0.1 * x, 4.0 - x), np.where(y <= 2.0, 2.3 - y, 0.5 - 0.1 * y))


Formula = Callable[..., Floats]

# Name: formula, marginals, published probability, probability as recomputed by `tests.bench.rare.reference`.
TABLE: dict[str, tuple[Formula, list[Marginal], float, float]] = {
    "RP8": (
        lambda a, b, c, d, e, f: a + 2.0 * b + 2.0 * c + d - 5.0 * e - 5.0 * f,
        [lognormal(120.0, 12.0)] * 4 + [lognormal(50.0, 10.0), lognormal(40.0, 8.0)],
        7.84e-4,
        7.89830e-4,
    ),
    "RP14": (
        rp14,
        [uniform(70.0, 80.0), normal(39.0, 0.1), gumbel(1500.0, 350.0), normal(400.0, 0.1), normal(2.5e5, 3.5e4)],
        7.7285e-4,
        7.71570e-4,
    ),
    "RP22": (
        lambda x, y: 2.5 - (x + y) / sqrt(2.0) + 0.1 * (x - y) ** 2,
        [STANDARD] * 2,
        4.2073e-3,
        4.20731e-3,
    ),
    "RP24": (
        lambda x, y: 2.5 - 0.2357 * (x - y) + 0.00463 * (x + y - 20.0) ** 4,
        [normal(10.0, 3.0)] * 2,
        2.86e-3,
        2.85995e-3,
    ),
    "RP25": (
        lambda x, y: np.maximum(x**2 - 8.0 * y + 16.0, -16.0 * x + y + 32.0),
        [STANDARD] * 2,
        4.1486e-5,
        4.14823e-5,
    ),
    "RP28": (lambda x, y: x * y - 146.14, [normal(78064.0, 11710.0), normal(0.0104, 0.00156)], 1.46e-7, 1.45327e-7),
    "RP31": (lambda x, y: 2.0 - y + 256.0 * x**4, [STANDARD] * 2, 3.2267e-3, 3.22668e-3),
    "RP33": (
        lambda x, y, z: np.minimum(3.0 * sqrt(3.0) - x - y - z, 3.0 - z),
        [STANDARD] * 3,
        2.57e-3,
        2.57560e-3,
    ),
    "RP35": (rp35, [STANDARD] * 2, 3.4789e-3, 3.47894e-3),
    "RP38": (
        rp38,
        [normal(m, m / 10.0) for m in (350.0, 50.8, 3.81, 173.0, 9.38, 33.1, 0.036)],
        8.1e-3,
        8.05103e-3,
    ),
    "RP53": (
        lambda x, y: np.sin(2.5 * x) + 2.0 - (x**2 + 4.0) * (y - 1.0) / 20.0,
        [normal(1.5, 1.0), normal(2.5, 1.0)],
        3.13e-2,
        3.13191e-2,
    ),
    "RP54": (lambda *x: np.sum(x, axis=0) - 8.951, [exponential] * 20, 9.98e-4, 9.90603e-4),
    "RP57": (rp57, [STANDARD] * 2, 2.84e-2, 2.82345e-2),
    "RP60": (
        rp60,
        [lognormal(m, m / 10.0) for m in (2200.0, 2100.0, 2300.0, 2000.0)] + [lognormal(1200.0, 480.0)],
        4.56e-2,
        4.48404e-2,
    ),
    "RP75": (lambda x, y: 3.0 - x * y, [STANDARD] * 2, 9.8193e-3, 9.81926e-3),
    "RP77": (
        lambda x, y, z: np.where(z <= 5.0, x - y - z, z - y),
        [normal(10.0, 0.5), STANDARD, normal(4.0, 1.0)],
        2.87e-7,
        2.69084e-7,
    ),
    "RP89": (lambda x, y: np.minimum(8.0 - x**2 - y, 6.0 - x / 5.0 - y), [STANDARD] * 2, 5.43e-3, 5.47129e-3),
    "RP91": (
        rp91,
        [normal(0.07433, 0.005), normal(0.1, 0.01), normal(13.0, 60.0), normal(4751.0, 48.0), normal(-684.0, 11.0)],
        6.97e-4,
        7.00252e-4,
    ),
    "RP107": (lambda *x: 5.0 * sqrt(10.0) - np.sum(x, axis=0), [STANDARD] * 10, 2.92e-7, 2.86652e-7),
    "RP110": (rp110, [STANDARD] * 2, 3.19e-5, 3.19579e-5),
    "RP111": (lambda x, y: 12.5 - np.abs(x * y), [STANDARD] * 2, 7.65e-7, 8.03509e-7),
    "four branches": (four_branches, [STANDARD] * 2, 2.2228e-3, 2.22277e-3),
}


def _costs(formula: Formula, marginals: list[Marginal]) -> Callable[[Floats], Floats]:
    return lambda u: np.asarray(formula(*(of(u[:, k]) for k, of in enumerate(marginals))), dtype=np.float64)


PUBLIC = [
    Problem(name, len(marginals), _costs(formula, marginals), known, ("setting", "judging")[k % 2], published)
    for k, (name, (formula, marginals, published, known)) in enumerate(TABLE.items())
]
