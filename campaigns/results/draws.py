"""Each draw of a random sample from the sample's seed and the draw's index alone: its noise seed, its random numbers.

Noise: the highest bits of SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
Numbers: Philox, a generator that encrypts a counter (Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC11).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.scenario import MAX_REALISATION, MAX_SEED

_GAMMA = 0x9E3779B97F4A7C15
_BITS = MAX_SEED.bit_length() - 1
assert 1 << _BITS == MAX_SEED
_WORDS = 4
"""Numbers that one value of Philox's counter gives."""
_WIDE = MAX_REALISATION.bit_length() - 1
"""Bits of a noise seed of a sample of any size, which 2^20 realisations would not represent."""


def of_draws(seed: int, first: int, count: int) -> NDArray[np.int64]:
    """The realisations of the draws `first`, first + 1, ... of a sample with this seed that is stored whole."""
    return (_hashed(seed, np.arange(first, first + count)) >> np.uint64(64 - _BITS)).astype(np.int64)


def of_indices(seed: int, indices: NDArray[np.int64]) -> NDArray[np.int64]:
    """The realisations of these draws of a sample of any size."""
    return (_hashed(seed, indices) >> np.uint64(64 - _WIDE)).astype(np.int64)


def combined(seeds: NDArray[np.int64], number: int, own: NDArray[np.float64]) -> NDArray[np.float64]:
    """A whole number below 2^53 for each realisation, from a component's own seed (whole, below 2^24) and its number in
    the scenario."""
    named = own.astype(np.uint64) | np.uint64(number << 24)
    mixed = _mixed(_mixed(seeds.astype(np.uint64) * np.uint64(_GAMMA)) ^ (named * np.uint64(_GAMMA)))
    return (mixed >> np.uint64(64 - 53)).astype(np.float64)


def uniform(seed: int, stream: int, first: int, count: int, dimension: int) -> NDArray[np.float64]:
    """The random numbers in [0, 1) of the draws `first`, first + 1, ... of a sample (count, dimension)."""
    steps = -(-dimension // _WORDS)
    key = np.random.SeedSequence(seed, spawn_key=(stream,)).generate_state(2, np.uint64)
    numbers = np.random.Generator(np.random.Philox(key=key, counter=first * steps))
    return numbers.random((count, steps * _WORDS))[:, :dimension]


def _hashed(seed: int, indices: NDArray[np.int64]) -> NDArray[np.uint64]:
    stream = _mixed(np.array([seed + 1], dtype=np.uint64) * np.uint64(_GAMMA))
    return _mixed(stream + (indices.astype(np.uint64) + np.uint64(1)) * np.uint64(_GAMMA))


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
