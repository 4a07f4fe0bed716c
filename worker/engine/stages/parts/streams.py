"""The random streams of stages: each stage has its own, derived from the campaign's seed."""

from __future__ import annotations

import numpy as np


def stream(seed: int, index: int) -> np.random.Generator:
    """The random stream of search stage `index`: independent of every other stage and of the worker."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
