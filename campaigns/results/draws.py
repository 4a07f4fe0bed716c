"""The noise seed of each draw of a random sample, computed from the sample's seed and the draw's index.

The highest bits of SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.spec import MAX_SEED

_GAMMA = 0x9E3779B97F4A7C15
_BITS = MAX_SEED.bit_length() - 1
assert 1 << _BITS == MAX_SEED


def of_draws(seed: int, first: int, count: int) -> NDArray[np.int64]:
    """The realisations of the draws `first`, first + 1, ... of a sample with this seed."""
    index = np.arange(first, first + count, dtype=np.uint64)
    stream = _mixed(np.array([seed + 1], dtype=np.uint64) * np.uint64(_GAMMA))
    mixed = _mixed(stream + (index + np.uint64(1)) * np.uint64(_GAMMA))
    return (mixed >> np.uint64(64 - _BITS)).astype(np.int64)


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
