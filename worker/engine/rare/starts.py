"""The violations that an estimate begins with: the lowest of those that are stored, apart from each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare.evaluated import Floats

APART, MOST, EACH = 0.1, 100, 50
"""How far they are apart at least, as a fraction of a range; how many at most, and one for so many evaluations."""
TAIL = 1e-9
"""A violation on a bound counts as this far in the tail of the distribution."""


def chosen(points: Floats, costs: Floats, budget: int) -> NDArray[np.int64]:
    """Rows of violations (m, n) of the unit cube, the lowest first; infinite costs are of failed evaluations.

    Without a violation there is no row: what only fails says nothing of violations.
    """
    if not (costs < np.inf).any():
        return np.empty(0, dtype=np.int64)
    left, found = np.argsort(costs, kind="stable"), list[int]()
    while len(left) and len(found) < min(MOST, budget // EACH):
        found.append(int(left[0]))
        left = left[np.abs(points[left] - points[left[0]]).max(axis=1) > APART]
    return np.array(found, dtype=np.int64)


def normal(uniform: Floats) -> Floats:
    """Uniform samples (m, n) of starts in standard normal space."""
    from scipy import special  # imported late: a campaign's process must start fast

    return np.asarray(special.ndtri(np.clip(uniform, TAIL, 1.0 - TAIL)))
