"""Selects the rows of a long series that a chart or a stored trace needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from campaigns.cube import Floats

Indices = NDArray[np.int64]

NEAR = 25
"""Rows on either side of a closest approach that are never left out."""


def even(count: int, most: int) -> Indices:
    """Choose at most `most` of `count` indices, evenly spread, the first and the last among them."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.linspace(0, count - 1, most).round().astype(np.int64))


def improvements(costs: Floats, best: float = np.inf) -> Indices:
    """The indices at which a series is lower than `best` and all earlier values; NaN is not a cost."""
    filled = np.where(np.isnan(costs), np.inf, costs)
    before = np.minimum.accumulate(np.concatenate([[best], filled]))[:-1]
    return np.flatnonzero(filled < before)


def with_kept(count: int, most: int, kept: Indices) -> Indices:
    """Choose at most `most` of `count` indices: those to keep (thinned themselves when too many), and an even
    choice."""
    kept = kept[even(len(kept), most)]
    rest = even(count, max(0, most - len(kept))) if most > len(kept) else kept[:0]
    return np.union1d(kept, rest)


def around(count: int, most: int, middle: int) -> Indices:
    """Choose at most `most` of `count` rows: ends, an even choice, and all of those next to the middle."""
    beside = near(count, middle, min(NEAR, max(0, (most - 3) // 4)))
    return with_kept(count, most, np.union1d(beside, np.array([0, count - 1])))


def near(count: int, middle: int, reach: int) -> Indices:
    """The indices of `count` rows that are at most `reach` from the middle."""
    return np.arange(max(0, middle - reach), min(count, middle + reach + 1))
