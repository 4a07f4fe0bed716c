"""(mu/mu_w, lambda)-CMA-ES as a compiled state machine for many instances, restarted at the best point.

Hansen, The CMA evolution strategy: a tutorial (arXiv:1604.00772, 2016), with its constants, but with a Cholesky factor
in place of the symmetric square root (Suttorp, Hansen, Igel, Machine Learning 75, 2009). Points are reflected at the
faces of the box; a point without a value is redrawn up to five times and then ignored.
"""

from __future__ import annotations

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.search.base import Floats
from worker.engine.search.racing.state import BEGIN, CMA, Ints, State, inner

Random = np.random.Generator

FINEST = 1e-6
"""An instance restarts when all its standard deviations are below this."""
FLAT, REDRAWS = 10, 5


@compiled
def tell(s: State, rows: Ints, random: Random) -> None:
    """Advance the CMA-ES instances among these searchers until each requests points."""
    for t in rows:
        if s.kind[t] != CMA:
            continue
        if s.stage[t] == BEGIN:
            _begin(s, t, random)
        elif not _redrawn(s, t, random):
            _learn(s, t)
            if s.flat[t] >= FLAT or not _widest(s, t) >= FINEST:
                s.step[t] = s.begin[t, 1]
                _begin(s, t, random)
            else:
                _draw_all(s, t, random)


@inner
def _begin(s: State, t: int, random: Random) -> None:
    n = s.best.shape[1]
    s.flat[t] = 0
    for i in range(n):
        for k in range(n):
            s.matrix[t, i, k] = s.factor[t, i, k] = 1.0 if i == k else 0.0
    for k in range(n):
        s.matrix[t, n, k] = 0.0
        s.vectors[t, 0, k] = s.vectors[t, 2, k] = s.vectors[t, 3, k] = 0.0
        s.vectors[t, 1, k] = s.best[t, k]
    _draw_all(s, t, random)


@inner
def _draw_all(s: State, t: int, random: Random) -> None:
    s.stage[t] = 0
    s.requested[t] = int(s.rates[6])
    for i in range(s.requested[t]):
        s.which[t, i] = i
        _draw(s, t, i, random)


@inner
def _draw(s: State, t: int, i: int, random: Random) -> None:
    """Point i: mean + sigma A z, reflected."""
    n = s.best.shape[1]
    for k in range(n):
        s.order[t, k] = random.standard_normal()
    for k in range(n):
        y = 0.0
        for j in range(k + 1):
            y += s.factor[t, k, j] * s.order[t, j]
        x = abs(s.vectors[t, 1, k] + s.step[t] * y) % 2.0
        s.points[t, i, k] = 2.0 - x if x > 1.0 else x


@inner
def _redrawn(s: State, t: int, random: Random) -> bool:
    """Redraw and request points without a value; returns whether there are any."""
    lost = 0
    if s.stage[t] < REDRAWS:
        for i in range(int(s.rates[6])):
            if not np.isfinite(s.values[t, i]):
                s.which[t, lost] = i
                lost += 1
                _draw(s, t, i, random)
    s.stage[t] += 1
    s.requested[t] = lost
    return lost > 0


@inner
def _learn(s: State, t: int) -> None:
    """Update mean, evolution paths, covariance and step size by one generation."""
    population = int(s.rates[6])
    rank = np.empty(population, np.int64)
    known = _ranked(s, t, rank)
    if known == 0 or s.values[t, rank[0]] == s.values[t, rank[known - 1]]:
        s.flat[t] += 1
    else:
        s.flat[t] = 0
    if known == 0:
        s.step[t] *= 0.5
        return
    if s.values[t, rank[0]] < s.cost[t]:
        s.cost[t] = s.values[t, rank[0]]
        for k in range(s.best.shape[1]):
            s.best[t, k] = s.points[t, rank[0], k]
    _adapt(s, t, rank, min(len(s.weights), known))
    _factorise(s, t)


@inner
def _ranked(s: State, t: int, rank: Ints) -> int:
    """Rank a generation from its lowest value, by insertion sort; returns the number of points with a value."""
    known = 0
    for i in range(len(rank)):
        value = s.values[t, i]
        known += 1 if np.isfinite(value) else 0
        j = i
        while j > 0 and (value < s.values[t, rank[j - 1]] or (np.isnan(s.values[t, rank[j - 1]]) and value == value)):
            rank[j] = rank[j - 1]
            j -= 1
        rank[j] = i
    return known


@inner
def _adapt(s: State, t: int, rank: Ints, mu: int) -> None:
    """Mean, evolution paths, covariance and sigma from the mu best points (Hansen 2016, equations 24 to 37)."""
    n, sigma = s.best.shape[1], s.step[t]
    total = 0.0
    for i in range(mu):
        total += s.weights[i]
    m, c_sigma, d_sigma, c_c, c_1, c_mu = s.rates[0], s.rates[1], s.rates[2], s.rates[3], s.rates[4], s.rates[5]
    mean, path, walk = s.vectors[t, 1], s.vectors[t, 2], s.vectors[t, 3]
    old, y = np.empty(n), np.empty(n)
    for k in range(n):
        old[k] = mean[k]
        mean[k] = 0.0
        for i in range(mu):
            mean[k] += s.weights[i] / total * s.points[t, rank[i], k]
        y[k] = (mean[k] - old[k]) / sigma
    z = _solved(s.factor[t], y)
    squared = 0.0
    for k in range(n):
        walk[k] = walk[k] * (1.0 - c_sigma) + np.sqrt(c_sigma * (2.0 - c_sigma) * m) * z[k]
        squared += walk[k] * walk[k]
    length = np.sqrt(squared)
    expected = np.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
    h_sigma = 1.0 if length < (1.4 + 2.0 / (n + 1.0)) * expected else 0.0  # 0 stalls the path while sigma must grow
    for k in range(n):
        path[k] = path[k] * (1.0 - c_c) + h_sigma * np.sqrt(c_c * (2.0 - c_c) * m) * y[k]
    for a in range(n):
        for b in range(a + 1):
            many = 0.0
            for i in range(mu):
                p = s.points[t, rank[i]]
                many += s.weights[i] / total * (p[a] - old[a]) * (p[b] - old[b])
            s.matrix[t, a, b] = (
                (1.0 - c_1 - c_mu) * s.matrix[t, a, b] + c_1 * path[a] * path[b] + c_mu * many / sigma**2
            )
    s.step[t] = sigma * np.exp(min(1.0, c_sigma / d_sigma * (length / expected - 1.0)))


@inner
def _solved(factor: Floats, y: Floats) -> Floats:
    """Solve factor z = y for a lower triangular factor."""
    z = np.empty(len(y))
    for k in range(len(y)):
        z[k] = y[k]
        for j in range(k):
            z[k] -= factor[k, j] * z[j]
        z[k] /= factor[k, k]
    return z


@inner
def _factorise(s: State, t: int) -> None:
    """Cholesky factorisation; if rounding made the covariance indefinite, the step becomes 0 and causes a restart."""
    n = s.best.shape[1]
    for a in range(n):
        for b in range(a + 1):
            rest = s.matrix[t, a, b]
            for j in range(b):
                rest -= s.factor[t, a, j] * s.factor[t, b, j]
            if a == b:
                if not rest > 0.0:
                    s.step[t] = 0.0
                    return
                s.factor[t, a, a] = np.sqrt(rest)
            else:
                s.factor[t, a, b] = rest / s.factor[t, b, b]


@inner
def _widest(s: State, t: int) -> float:
    """The largest standard deviation of any parameter."""
    widest = 0.0
    for k in range(s.best.shape[1]):
        widest = max(widest, s.matrix[t, k, k])
    return float(s.step[t] * np.sqrt(widest))
