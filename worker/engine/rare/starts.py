"""The violations that an estimate begins with: the lowest, the most likely and those of the independent sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare.evaluated import Bools, Floats

APART, MOST, EACH = 0.1, 100, 50
"""How far the lowest are apart at least, as a fraction of a range; how many at most, and one for so many
evaluations."""
DISTANCE = 1.0
"""How far the others are from every start at least, in standard normal space: a tenth of a narrow distribution's range
may be several deviations, with another mode between."""
LEAST, HIGHEST = 1e-23, 1.0 - 2.0**-53
"""A violation on a bound counts as this far in the tail of the distribution: at ten deviations, and at eight where the
probabilities are close to 1."""


@dataclass(frozen=True)
class Stored:
    """Violations (m, n) in the unit cube, with their costs, infinite of failed evaluations, their points in standard
    normal space, and which are of the independent sample, in the order of its draws."""

    points: Floats
    costs: Floats
    normal: Floats
    sampled: Bools


def chosen(stored: Stored, budget: int) -> NDArray[np.int64]:
    """Rows of the starts, in turns the lowest, the most likely and the next of the independent sample.

    A deep region far in a tail alone would else take all of them, and a shallow one that is likely none. Without a
    violation there is no row: what only fails says nothing of violations.
    """
    if not (stored.costs < np.inf).any():
        return np.empty(0, dtype=np.int64)
    found, low = list[int](), np.argsort(stored.costs, kind="stable")
    others = [np.argsort(np.linalg.norm(stored.normal, axis=1), kind="stable"), np.flatnonzero(stored.sampled)]
    while (len(low) or any(map(len, others))) and len(found) < min(MOST, budget // EACH):
        for own in range(3):
            rows = others[own - 1] if own else low
            if not len(rows) or len(found) == min(MOST, budget // EACH):
                continue
            row = int(rows[0])
            found += [] if row in found else [row]
            if own == 0:
                low = low[distances(stored.points[low], stored.points[row]) > APART]
            others = [of[distances(stored.normal[of], stored.normal[row]) > DISTANCE] for of in others]
    return np.array(found, dtype=np.int64)


def distances(points: Floats, to: Floats) -> Floats:
    """The largest difference (m,) of a coordinate."""
    return np.asarray(np.abs(points - to).max(axis=1))


def normal(uniform: Floats) -> Floats:
    """Uniform samples (m, n) of violations in standard normal space."""
    from scipy import special  # imported late: a campaign's process must start fast

    return np.asarray(special.ndtri(np.clip(uniform, LEAST, HIGHEST)))


def moved(uniform: Floats) -> Bools:
    """Which of the violations (m,) are farther in a tail than standard normal space has them."""
    return np.asarray(((uniform < LEAST) | (uniform > HIGHEST)).any(axis=1))
