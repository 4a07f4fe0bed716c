"""The starts of estimates before version 15 of the rules, with which the searches of their records are repeated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare.evaluated import Floats
from worker.engine.rare.starts import APART, EACH, MOST, distances

TAIL = 1e-9


def chosen(points: Floats, costs: Floats, budget: int) -> NDArray[np.int64]:
    """Rows of the lowest violations (m, n) that are apart."""
    if not (costs < np.inf).any():
        return np.empty(0, dtype=np.int64)
    left, found = np.argsort(costs, kind="stable"), list[int]()
    while len(left) and len(found) < min(MOST, budget // EACH):
        found.append(int(left[0]))
        left = left[distances(points[left], points[left[0]]) > APART]
    return np.array(found, dtype=np.int64)


def normal(uniform: Floats) -> Floats:
    """Uniform samples (m, n) in standard normal space, at most six deviations away."""
    from scipy import special  # imported late: a campaign's process must start fast

    return np.asarray(special.ndtri(np.clip(uniform, TAIL, 1.0 - TAIL)))
