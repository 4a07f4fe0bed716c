"""Violations and their modes: each is of a known mode, or leads to the design point of a new one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare import design
from worker.engine.rare.evaluated import Allowance, Asking, Floats
from worker.engine.rare.known import ON_THE_WAY, Known

AT_ONCE, APART = 4, 0.7
"""Violations that are polished together, and the largest cosine between their directions."""


def explained(points: Floats, known: Known, allowed: Allowance, keep: int, origins: bool) -> Asking[int]:
    """Adds the modes of violations (k, n), in their order, until `keep` evaluations are left; how many have none then.

    Given violations are polished unless they are connected to a design point, and remembered as the origins of their
    modes. Others are passed over if they are beyond the tangent plane of a known mode.
    """
    n = points.shape[1]
    waiting = np.arange(len(points))
    while True:
        beyond = waiting[~known.explains(points[waiting])]
        waiting = waiting if origins else beyond
        count = min(AT_ONCE, (allowed.left - keep) // (design.cost(n) + (AT_ONCE + 1) * len(ON_THE_WAY)))
        if not len(waiting) or count < 1:
            return len(beyond)
        chosen, done = yield from _without_mode(points, waiting, known, allowed, count, origins)
        waiting = np.setdiff1d(waiting, done)
        if chosen:
            designs, slopes = yield from design.polished(points[chosen], allowed)
            yield from known.add(designs, slopes, chosen if origins else None, allowed)


def _without_mode(
    points: Floats, waiting: NDArray[np.int64], known: Known, allowed: Allowance, count: int, origins: bool
) -> Asking[tuple[list[int], list[int]]]:
    """Choose at most `count` waiting violations of no known mode, in different directions; also returns all tested
    ones."""
    chosen: list[int] = []
    done: list[int] = []
    lengths = np.maximum(np.linalg.norm(points, axis=1), 1e-12)
    for i in waiting.tolist():
        if len(chosen) == count or len(done) == AT_ONCE * count:
            break
        if any(points[i] @ points[j] > APART * lengths[i] * lengths[j] for j in chosen):
            continue
        done.append(i)
        mode = yield from known.of_mode(points[i], allowed)
        own = None if mode is None else known.origins[mode]
        if mode is None:
            chosen.append(i)
        elif origins and own is not None:
            own.append(i)
    return chosen, done
