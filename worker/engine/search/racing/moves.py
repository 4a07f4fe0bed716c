"""Compass search and Nelder-Mead as compiled state machines for many instances; both hand over to CMA-ES.

Compass: Kolda, Lewis, Torczon, Optimization by direct search (SIAM Review 45, 2003), over random bases; Nelder and Mead
(Computer Journal 7, 1965) with the coefficients of Gao and Han (Comput. Optim. Appl. 51, 2012), which suit any
dimension. A point without a value is never accepted.
"""

from __future__ import annotations

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.search.racing.state import BEGIN, CMA, COMPASS, NELDER_MEAD, Ints, State, inner

Random = np.random.Generator

FINE = 1e-4
"""A search hands over to CMA-ES when its step is below this."""


@compiled
def tell(s: State, rows: Ints, random: Random) -> None:
    """Advance the compass and Nelder-Mead searchers among these until each requests points or is handed over."""
    for t in rows:
        if s.kind[t] == COMPASS:
            if s.stage[t] == BEGIN:
                s.step[t] = s.begin[t, 0]
                _poll(s, t, random)
                _compass_next(s, t, random)
            else:
                _compass_tell(s, t, random)
        elif s.kind[t] == NELDER_MEAD:
            if s.stage[t] == BEGIN:
                s.step[t] = s.begin[t, 0]
                _simplex_begin(s, t)
            else:
                _simplex_tell(s, t)


@inner
def _hand_over(s: State, t: int) -> None:
    s.kind[t] = CMA
    s.stage[t] = BEGIN
    s.step[t] = s.begin[t, 1]
    s.requested[t] = 0


@inner
def _clip(x: float) -> float:
    return min(max(x, 0.0), 1.0)


@inner
def _request(s: State, t: int, count: int) -> None:
    """Request the first `count` rows of its points."""
    s.requested[t] = count
    for i in range(count):
        s.which[t, i] = i


@inner
def _accept(s: State, t: int, i: int) -> bool:
    """Make point i the incumbent if it is better."""
    if not s.values[t, i] < s.cost[t]:
        return False
    s.cost[t] = s.values[t, i]
    for k in range(s.best.shape[1]):
        s.best[t, k] = s.points[t, i, k]
    return True


# ---- compass search: a random orthonormal basis per poll, the last successful direction first


@inner
def _poll(s: State, t: int, random: Random) -> None:
    """Draw a random basis (Gram-Schmidt) and a random order; position -1 is the last successful direction."""
    n = s.best.shape[1]
    q = s.matrix[t]
    for i in range(n):
        norm = 0.0
        while norm < 1e-3:
            for k in range(n):
                q[i, k] = random.standard_normal()
            for j in range(i):
                along = 0.0
                for k in range(n):
                    along += q[i, k] * q[j, k]
                for k in range(n):
                    q[i, k] -= along * q[j, k]
            norm = 0.0
            for k in range(n):
                norm += q[i, k] * q[i, k]
            norm = np.sqrt(norm)
        for k in range(n):
            q[i, k] /= norm
    for i in range(2 * n):
        j = int(random.random() * (i + 1))
        s.order[t, i] = s.order[t, j]
        s.order[t, j] = i
    s.stage[t] = -2


@inner
def _compass_next(s: State, t: int, random: Random) -> None:
    """Request the next point of the poll that differs from the incumbent; after the last one, halve the step."""
    n = s.best.shape[1]
    while s.step[t] >= FINE:
        s.stage[t] += 1
        at = s.stage[t]
        if at == 2 * n:
            s.step[t] *= 0.5
            _poll(s, t, random)
            continue
        moved = 0.0
        for k in range(n):
            if at < 0:
                along = s.vectors[t, 0, k]
            else:
                d = int(s.order[t, at])
                along = s.matrix[t, d // 2, k] * (1.0 if d % 2 == 0 else -1.0)
            s.points[t, 0, k] = _clip(s.best[t, k] + s.step[t] * along)
            moved = max(moved, abs(s.points[t, 0, k] - s.best[t, k]))
        if moved > 0.0:
            _request(s, t, 1)
            return
    _hand_over(s, t)


@inner
def _compass_tell(s: State, t: int, random: Random) -> None:
    if _accept(s, t, 0):
        at = s.stage[t]
        if at < 0:
            s.step[t] = min(2.0 * s.step[t], 0.5)
        else:
            d = int(s.order[t, at])
            for k in range(s.best.shape[1]):
                s.vectors[t, 0, k] = s.matrix[t, d // 2, k] * (1.0 if d % 2 == 0 else -1.0)
        _poll(s, t, random)
    _compass_next(s, t, random)


# ---- Nelder-Mead with the coefficients of Gao and Han (2012)


@inner
def _simplex_begin(s: State, t: int) -> None:
    """Request one vertex per axis, towards the inside at the faces of the box."""
    n = s.best.shape[1]
    for i in range(n):
        for k in range(n):
            s.points[t, i, k] = s.best[t, k]
        h = s.step[t]
        s.points[t, i, i] += h if s.best[t, i] + h <= 1.0 else -h
    for k in range(n):
        s.matrix[t, 0, k] = s.best[t, k]
    s.order[t, 0] = s.cost[t]
    s.stage[t] = 0
    _request(s, t, n)


@inner
def _simplex_point(s: State, t: int, i: int, along: float) -> None:
    """Point i of the request: on the line from the worst vertex through the centroid of the others."""
    n = s.best.shape[1]
    for k in range(n):
        centre = 0.0
        for j in range(n):
            centre += s.matrix[t, j, k]
        centre /= n
        s.points[t, i, k] = _clip(centre + along * (centre - s.matrix[t, n, k]))


@inner
def _simplex_put(s: State, t: int, row: int, i: int) -> None:
    """Point i becomes vertex `row`."""
    for k in range(s.best.shape[1]):
        s.matrix[t, row, k] = s.points[t, i, k]
    s.order[t, row] = s.values[t, i]


@inner
def _simplex_tell(s: State, t: int) -> None:
    """Stages: 0 initial vertices or shrink, 1 reflection, 2 expansion, 3 outside contraction, 4 inside contraction."""
    n = s.best.shape[1]
    requested, stage = s.requested[t], s.stage[t]
    for i in range(requested):
        _accept(s, t, i)
    expand, contract, shrink = 1.0 + 2.0 / n, 0.75 - 0.5 / n, max(1.0 - 1.0 / n, 0.5)
    value = s.values[t, 0]
    if stage == 0:
        for i in range(n):
            _simplex_put(s, t, i + 1, i)
    elif stage == 1:
        for k in range(n):
            s.points[t, 1, k] = s.points[t, 0, k]  # the reflected point, in case the next point is worse
        s.values[t, 1] = value
        if value < s.order[t, 0]:
            s.stage[t] = 2
            _simplex_point(s, t, 0, expand)
            _request(s, t, 1)
            return
        if value < s.order[t, n - 1]:
            _simplex_put(s, t, n, 1)
        else:
            outside = value < s.order[t, n]
            s.stage[t] = 3 if outside else 4
            _simplex_point(s, t, 0, contract if outside else -contract)
            _request(s, t, 1)
            return
    elif stage == 2:
        _simplex_put(s, t, n, 0 if value < s.values[t, 1] else 1)
    elif (stage == 3 and value <= s.values[t, 1]) or (stage == 4 and value < s.order[t, n]):
        _simplex_put(s, t, n, 0)
    else:
        for i in range(n):
            for k in range(n):
                s.points[t, i, k] = _clip(s.matrix[t, 0, k] + shrink * (s.matrix[t, i + 1, k] - s.matrix[t, 0, k]))
        s.stage[t] = 0
        _request(s, t, n)
        return
    _simplex_next(s, t)


@inner
def _sort(s: State, t: int) -> None:
    """Sort the vertices by cost (insertion sort); those without a value come last."""
    n = s.best.shape[1]
    for i in range(1, n + 1):
        j = i
        while j > 0:
            left, right = s.order[t, j - 1], s.order[t, j]
            if not (right < left or (np.isnan(left) and not np.isnan(right))):
                break
            s.order[t, j - 1], s.order[t, j] = right, left
            for k in range(n):
                s.matrix[t, j - 1, k], s.matrix[t, j, k] = s.matrix[t, j, k], s.matrix[t, j - 1, k]
            j -= 1


@inner
def _simplex_next(s: State, t: int) -> None:
    """Sort the vertices and reflect the worst, or hand over when the simplex is small."""
    n = s.best.shape[1]
    _sort(s, t)
    size = 0.0
    for i in range(1, n + 1):
        for k in range(n):
            size = max(size, abs(s.matrix[t, i, k] - s.matrix[t, 0, k]))
    if size < FINE:
        _hand_over(s, t)
        return
    s.stage[t] = 1
    _simplex_point(s, t, 0, 1.0)
    _request(s, t, 1)
