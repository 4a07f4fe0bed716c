"""UNIRANDI: a local search along random directions that uses only values.

Jarvi, A random search optimizer (University of Turku, 1973), as in GLOBAL (Csendes 1988): a step along a random
direction or against it; a successful step is doubled until it fails, two failures halve it.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from campaigns.results.base import OK
from worker.engine.search.base import Batch, Ended, Floats
from worker.engine.search.parts.descent import End

STEP = 0.0005
"""The first step in fractions of the ranges: 0.001 on the original's box from -1 to 1."""
BLOCK = 64
TINY = 1e-300


def unirandi(
    random: np.random.Generator, start: Floats, cost: float, tolerance: float, most: int
) -> Generator[Floats, Batch, End]:
    """Search from a start of known cost, one point at a time, at most `most`; steps across a bound end on it.

    It ends after two failures if the relative gain of the last line or the step is below the tolerance.
    """
    tolerance = max(tolerance, 1e-14)  # below that no step changes a point
    point, step, failures, gain, spent = start.copy(), STEP, 0, 1.0, 0
    while True:
        directions = random.standard_normal((BLOCK, len(start)))
        directions /= np.sqrt((directions * directions).sum(axis=1, keepdims=True))
        for direction in directions:
            better = False
            for reach in (step, -step):
                # Double the step while it succeeds; the first failure ends the line.
                while True:
                    trial = np.minimum(np.maximum(point + reach * direction, 0.0), 1.0)
                    if (trial == point).all():
                        break
                    if spent >= most:
                        return End(
                            point, cost, spent, Ended("share", "used its {evaluations} evaluations", evaluations=most)
                        )
                    batch = yield trial[None, :].copy()
                    spent += 1
                    value = batch.costs[0, 0]
                    if batch.status[0] != OK or not value < cost:
                        break
                    gain = (cost - value) / max(abs(value), TINY)
                    point, cost, better = trial, float(value), True
                    reach *= 2.0
                if better:
                    step = 0.5 * abs(reach)
                    break
            if better:
                failures = 0
                continue
            failures += 1
            if failures == 2:
                step, failures = 0.5 * step, 0
                if gain < tolerance:
                    return End(point, cost, spent, Ended("converged", "the cost no longer changes"))
                if step < tolerance:
                    return End(point, cost, spent, Ended("converged", "the step is within its tolerance"))
