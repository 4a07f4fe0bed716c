"""Each draw of a random sample from the sample's seed and the draw's index alone: its noise seed, its random numbers.

Noise: the highest bits of SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
Numbers: Philox, a generator that encrypts a counter (Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC11).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.spec import MAX_SEED

_GAMMA = 0x9E3779B97F4A7C15
_BITS = MAX_SEED.bit_length() - 1
assert 1 << _BITS == MAX_SEED
_WORDS = 4
"""Numbers that one value of Philox's counter gives."""


def of_draws(seed: int, first: int, count: int) -> NDArray[np.int64]:
    """The realisations of the draws `first`, first + 1, ... of a sample with this seed."""
    index = np.arange(first, first + count, dtype=np.uint64)
    stream = _mixed(np.array([seed + 1], dtype=np.uint64) * np.uint64(_GAMMA))
    mixed = _mixed(stream + (index + np.uint64(1)) * np.uint64(_GAMMA))
    return (mixed >> np.uint64(64 - _BITS)).astype(np.int64)


def uniform(seed: int, stream: int, first: int, count: int, dimension: int) -> NDArray[np.float64]:
    """The random numbers in [0, 1) of the draws `first`, first + 1, ... of a sample (count, dimension)."""
    steps = -(-dimension // _WORDS)
    key = np.random.SeedSequence(seed, spawn_key=(stream,)).generate_state(2, np.uint64)
    numbers = np.random.Generator(np.random.Philox(key=key, counter=first * steps))
    return numbers.random((count, steps * _WORDS))[:, :dimension]


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
