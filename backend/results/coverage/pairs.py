"""Which bins of every pair of parameters have an evaluation: pairwise coverage of ranges divided into equal bins.

Kuhn, Kacker, Lei (NIST SP 800-142, 2010), section 2, with bins of a range as the values of a parameter.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from backend.results.coverage.tree import Floats

BINS = 10
"""Of each range; a pair has the square of it."""


class Pair(NamedTuple):
    first: int
    second: int
    touched: int
    """Of BINS * BINS bins, those with an evaluation."""


def touched(points: Floats) -> list[Pair]:
    """Every pair of parameters, the least covered first; points: (m, n) of the unit cube."""
    bins = np.minimum((points * BINS).astype(np.int64), BINS - 1)
    found = [
        Pair(a, b, int(np.count_nonzero(np.bincount(bins[:, a] * BINS + bins[:, b], minlength=BINS**2))))
        for a, b in itertools.combinations(range(points.shape[1]), 2)
    ]
    return sorted(found, key=lambda pair: pair.touched)
