"""A cost of several valleys whose places and depths are known."""

from __future__ import annotations

import numpy as np

from clearance.testing.searching import Function
from worker.engine.search.base import Floats


def wells(*places: tuple[float, float, float]) -> Function:
    """Gaussian wells in the plane: x, y, depth."""

    def value(x: Floats) -> Floats:
        found = np.zeros(len(x))
        for a, b, depth in places:
            found -= depth * np.exp(-((x - [a, b]) ** 2).sum(axis=1) / 0.02)
        return found

    return value
