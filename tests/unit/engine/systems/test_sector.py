"""The nearest place of where a turning vehicle may be: of all places, whichever are left out at first."""

from __future__ import annotations

import numpy as np
import pytest

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.further import turning


def _of_all(relative: Floats, velocity: Floats, turned: float, half: float, times: Floats, steady: bool) -> Floats:
    """The distance of every place from the sector."""
    speed, there = float(np.linalg.norm(velocity)), np.linalg.norm(relative, axis=1)
    angles = np.arccos(np.clip(relative @ velocity / np.maximum(there * speed, 1e-300), -1.0, 1.0))
    aside = np.clip(angles - turned * (1.0 + times / half), 0.0, 0.5 * np.pi)
    gone = np.clip(there * np.cos(aside), 0.0, speed * (np.minimum(times, 2.0 * half / turned) if steady else times))
    found: Floats = np.sqrt(np.maximum(there**2 + gone**2 - 2.0 * there * gone * np.cos(aside), 0.0))
    return found


@pytest.mark.parametrize("steady", [False, True])
@pytest.mark.parametrize("seed", range(40))
def test_it_is_that_of_all_places(seed: int, steady: bool) -> None:
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 400))
    times = np.linspace(0.0, random.uniform(1.0, 30.0), count)
    path = np.outer(times, random.normal(size=3)) if seed % 2 else random.normal(size=(count, 3))
    relative = random.normal(scale=20.0, size=3) * (seed % 3 > 0) + path
    velocity = random.normal(size=3) * (seed % 5 > 0)
    turned, half = random.uniform(0.05, 3.0), random.uniform(0.5, 5.0)
    every = _of_all(relative, velocity, turned, half, times, steady)
    k = int(np.argmin(every))
    assert turning(relative, velocity, turned, half, times, steady) == (every[k], times[k])
