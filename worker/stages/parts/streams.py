"""The random numbers of stages: each stage has a stream of its own, made of the campaign's seed."""

from __future__ import annotations

import numpy as np


def stream(seed: int, index: int) -> np.random.Generator:
    """The random numbers of search stage `index`: independent of every other stage and of who carries it out."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
