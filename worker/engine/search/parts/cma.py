"""(mu/mu_w, lambda)-CMA-ES over the unit cube, compiled: one strategy from a start to its stop.

Hansen, The CMA evolution strategy: a tutorial (arXiv:1604.00772, 2016), with its constants and negative weights, but
with a Cholesky factor in place of the symmetric square root (Krause, Arbones, Igel, NIPS 2016). Points outside the box
are mirrored at its faces; the first point of a generation is moved to the face, so that corners are evaluated exactly.
The strategy adapts to the repaired points, except close to a face, where it would shrink too early: there it adapts to
the points as drawn. A point without a value ranks last.
"""

from __future__ import annotations

from contextlib import suppress
from typing import NamedTuple

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.search.base import Ended, Floats
from worker.engine.search.parts.one_thread import one_thread
from worker.engine.search.racing.state import Ints, constants, inner

STEP = 1e-11
"""A strategy stops when its deviations are below this fraction of every range."""
CLOSE = 0.75
"""The distance of the mean from a face, in deviations, below which it counts as close."""
WIDEST = 1.0 / 3.0
"""The largest deviation; wider ones sample the box no better."""
CHANGE, DIGITS = 1e-12, 1e-15
"""Changes of the cost that count as none, absolute and relative."""
CONDITION = 1e14
MEMORY = 120
"""Least number of generations over which a stagnating strategy is observed."""

GOES_ON, FLAT, SAME, SMALL, STAGNANT, NARROW = range(6)
STOPS = {
    FLAT: Ended("converged", "the cost is constant around the best point"),
    SAME: Ended("converged", "the cost no longer changes"),
    SMALL: Ended("converged", "the step is within its tolerance"),
    STAGNANT: Ended("converged", "the cost stopped improving"),
    NARROW: Ended("rounding", "the valley is too narrow for floating-point numbers"),
}


class State(NamedTuple):
    """One strategy of n parameters and lambda points."""

    mean: Floats
    """(n,)"""
    sigma: Floats
    """(1,)"""
    path: Floats
    """(n,) evolution path of the covariance"""
    walk: Floats
    """(n,) evolution path of sigma"""
    covariance: Floats
    """(n, n) its lower triangle"""
    factor: Floats
    """(n, n) its Cholesky factor"""
    normal: Floats
    """(lambda, n) z of the tutorial"""
    moved: Floats
    """(lambda, n) y = A z"""
    weights: Floats
    """(lambda,) negative beyond mu"""
    rates: Floats
    """(6,) mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu"""
    counts: Ints
    """(2,) generations, generations whose values are equal"""
    lowest: Floats
    """(g,) lowest value of each generation"""
    middle: Floats
    """(g,) median value of each generation"""


class Normal(NamedTuple):
    """A normal distribution: mean (n,), standard deviation, and covariance (n, n) relative to its square."""

    mean: Floats
    deviation: float
    covariance: Floats


def default_population(dimension: int) -> int:
    """The tutorial's lambda."""
    return 4 + int(3 * np.log(dimension))


class Strategy:
    """`ask` gives a generation of points, `tell` takes their values; `ending` is the sentence of its stop."""

    def __init__(self, start: Floats, deviation: float, population: int, random: np.random.Generator) -> None:
        self.random = random
        self.state = _state(start, deviation, population)
        self.ending: Ended | None = None

    @classmethod
    def of(cls, first: Normal, population: int, random: np.random.Generator) -> Strategy:
        """A strategy whose first generation has this distribution, or with equal deviations where rounding made the
        covariance indefinite."""
        made = cls(first.mean, first.deviation, population, random)
        with suppress(np.linalg.LinAlgError), one_thread():
            made.state.factor[:] = np.linalg.cholesky(first.covariance)
            made.state.covariance[:] = first.covariance
        return made

    def ask(self) -> Floats:
        """The next generation (lambda, n)."""
        return _drawn(self.state, self.random)

    def tell(self, values: Floats) -> None:
        """Adapt to the values of the last generation (lambda,), infinity where there is none."""
        s = self.state
        if s.counts[0] == len(s.lowest):
            self.state = s = s._replace(
                lowest=np.concatenate([s.lowest, np.empty_like(s.lowest)]),
                middle=np.concatenate([s.middle, np.empty_like(s.middle)]),
            )
        self.ending = STOPS.get(_adapted(s, values, np.argsort(values, kind="stable")))


def _state(start: Floats, deviation: float, population: int) -> State:
    """A strategy at its start, with the constants of the tutorial's table 1."""
    n, mu = len(start), population // 2
    raw = np.log((population + 1) / 2) - np.log(np.arange(1, population + 1))
    better, worse = raw[:mu], raw[mu:]
    m = float(better.sum() ** 2 / (better**2).sum())
    negative = float(worse.sum() ** 2 / (worse**2).sum())
    rates = constants(n, m)
    c_1, c_mu = rates[-2:]
    sum_of_negative = min(1 + c_1 / c_mu, 1 + 2 * negative / (m + 2), (1 - c_1 - c_mu) / (n * c_mu))
    weights = np.concatenate([better / better.sum(), worse * (sum_of_negative / np.abs(worse).sum())])
    return State(
        mean=np.array(start, dtype=np.float64), sigma=np.array([deviation]), path=np.zeros(n), walk=np.zeros(n),
        covariance=np.eye(n), factor=np.eye(n), normal=np.empty((population, n)), moved=np.empty((population, n)),
        weights=weights, rates=np.array(rates), counts=np.zeros(2, np.int64),
        lowest=np.empty(512), middle=np.empty(512),
    )  # fmt: skip


@compiled
def _drawn(s: State, random: np.random.Generator) -> Floats:
    """Points mean + sigma A z, repaired at the faces; y and z become those of the points to adapt to."""
    n = len(s.mean)
    points = np.empty((len(s.normal), n))
    for i in range(len(points)):
        for k in range(n):
            s.normal[i, k] = random.standard_normal()
        for k in range(n):
            y = 0.0
            for j in range(k + 1):
                y += s.factor[k, j] * s.normal[i, j]
            drawn = s.mean[k] + s.sigma[0] * y
            points[i, k] = min(max(drawn, 0.0), 1.0) if i == 0 else _mirrored(drawn)
            close = min(s.mean[k], 1.0 - s.mean[k]) < CLOSE * s.sigma[0] * np.sqrt(s.covariance[k, k])
            s.moved[i, k] = y if close and i > 0 else (points[i, k] - s.mean[k]) / s.sigma[0]
        for k in range(n):
            z = s.moved[i, k]
            for j in range(k):
                z -= s.factor[k, j] * s.normal[i, j]
            s.normal[i, k] = z / s.factor[k, k]
    return points


@inner
def _mirrored(x: float) -> float:
    """Into the unit interval."""
    x = abs(x) % 2.0
    return min(x, 2.0 - x)


@compiled
def _adapted(s: State, values: Floats, rank: Ints) -> int:
    """Update by one generation, ranked from its lowest value; returns why the strategy stops, or `GOES_ON`."""
    known = 0
    for value in values:
        known += 1 if np.isfinite(value) else 0
    same = known == 0 or values[rank[0]] == values[rank[min(known - 1, len(values) // 2)]]
    s.counts[1] = s.counts[1] + 1 if same else 0
    g = s.counts[0]
    s.lowest[g] = values[rank[0]]
    s.middle[g] = values[rank[len(values) // 2]]
    s.counts[0] += 1
    if known == 0:
        s.sigma[0] *= 0.5
    else:
        _move(s, rank, min(len(values) // 2, known))
        _spread(s, rank)
        if not _factorised(s):
            return NARROW
    return _stop(s, values, rank, known)


@inner
def _move(s: State, rank: Ints, mu: int) -> None:
    """The mean, both evolution paths and sigma (equations 38 to 46); the covariance decays and takes rank one."""
    n = len(s.mean)
    m, c_sigma, d_sigma, c_c, c_1 = s.rates[0], s.rates[1], s.rates[2], s.rates[3], s.rates[4]
    total = 0.0
    for i in range(mu):
        total += s.weights[i]
    y, squared = np.zeros(n), 0.0
    for k in range(n):
        z = 0.0
        for i in range(mu):
            y[k] += s.weights[i] / total * s.moved[rank[i], k]
            z += s.weights[i] / total * s.normal[rank[i], k]
        s.walk[k] = (1.0 - c_sigma) * s.walk[k] + np.sqrt(c_sigma * (2.0 - c_sigma) * m) * z
        squared += s.walk[k] ** 2
        s.mean[k] = _mirrored(s.mean[k] + s.sigma[0] * y[k])
    expected = np.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
    settled = np.sqrt(1.0 - (1.0 - c_sigma) ** (2.0 * s.counts[0]))
    h = 1.0 if np.sqrt(squared) / settled < (1.4 + 2.0 / (n + 1.0)) * expected else 0.0
    for k in range(n):
        s.path[k] = (1.0 - c_c) * s.path[k] + h * np.sqrt(c_c * (2.0 - c_c) * m) * y[k]
    weight = 0.0
    for value in s.weights:
        weight += value
    decay = 1.0 + c_1 * (1.0 - h) * c_c * (2.0 - c_c) - c_1 - s.rates[5] * weight
    for a in range(n):
        for b in range(a + 1):
            s.covariance[a, b] = decay * s.covariance[a, b] + c_1 * s.path[a] * s.path[b]
    s.sigma[0] *= np.exp(min(1.0, c_sigma / d_sigma * (np.sqrt(squared) / expected - 1.0)))


@inner
def _spread(s: State, rank: Ints) -> None:
    """The rank-mu update of the covariance (equation 47), the worse half with negative weights."""
    n = len(s.mean)
    for i in range(len(rank)):
        y, weight = s.moved[rank[i]], s.rates[5] * s.weights[i]
        if weight < 0.0:
            squared = 1e-300
            for k in range(n):
                squared += s.normal[rank[i], k] ** 2
            weight *= n / squared
        for a in range(n):
            for b in range(a + 1):
                s.covariance[a, b] += weight * y[a] * y[b]


@inner
def _factorised(s: State) -> bool:
    """Cholesky factorisation; False where rounding made the covariance indefinite or too ill-conditioned."""
    n = len(s.mean)
    least, most = np.inf, 0.0
    for a in range(n):
        for b in range(a + 1):
            rest = s.covariance[a, b]
            for j in range(b):
                rest -= s.factor[a, j] * s.factor[b, j]
            if a > b:
                s.factor[a, b] = rest / s.factor[b, b]
                continue
            if not rest > 0.0:
                return False
            s.factor[a, a] = np.sqrt(rest)
            least, most = min(least, rest), max(most, s.covariance[a, a])
    return most < CONDITION * least


@inner
def _stop(s: State, values: Floats, rank: Ints, known: int) -> int:
    """The stopping rules of BIPOP (Hansen 2009), in its order."""
    n, g = len(s.mean), s.counts[0]
    widest = 0.0
    for k in range(n):
        widest = max(widest, s.sigma[0] * np.sqrt(s.covariance[k, k]))
    if not widest > STEP:
        return SMALL
    if widest > WIDEST:
        s.sigma[0] *= WIDEST / widest
    if s.counts[1] >= 10:
        return FLAT
    past = 10 + int(np.ceil(30.0 * n / len(values)))
    if known == len(values) and g >= past:
        low, high = s.lowest[g - 1], values[rank[known - 1]]
        for i in range(g - past, g):
            low, high = min(low, s.lowest[i]), max(high, s.lowest[i])
        if high - low < max(CHANGE, DIGITS * abs(low)):
            return SAME
    window = max(MEMORY + int(30.0 * n / len(values)), int(0.2 * g))
    if g >= window and s.counts[0] % 10 == 0:
        part = int(0.3 * window)
        old, new = g - window, g - part
        if np.median(s.lowest[new:g]) >= np.median(s.lowest[old : old + part]) and np.median(
            s.middle[new:g]
        ) >= np.median(s.middle[old : old + part]):
            return STAGNANT
    return GOES_ON
