"""Violations and their modes: each is of a known mode, or leads to the design point of a new one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare import design
from worker.engine.rare.evaluated import Allowance, Asking, Bools, Floats
from worker.engine.rare.known import ON_THE_WAY, Known
from worker.engine.rare.starts import DISTANCE, distances

AT_ONCE, APART = 4, 0.7
"""Violations that are polished together, and the largest cosine between their directions."""


FARTHEST = 8.2
"""Stored violations beyond, of which not every point can be told from a bound, have no part in any probability."""
LARGE = 0.1
"""Of what the known modes have as half-spaces: what a stored violation may add as one without being examined."""


def examined(points: Floats, starts: Floats, known: Known, allowed: Allowance, keep: int) -> Asking[int]:
    """Adds the modes of stored violations (m, n) that matter and are of no known one, the most likely first, until
    `keep` evaluations are left; how many have none then.

    Those close to a start or to one that was examined are taken as of its mode. `origins` counts from the starts on.
    """
    order = np.argsort(np.linalg.norm(points, axis=1), kind="stable")
    order = order[np.abs(points[order]).max(axis=1, initial=0.0) < FARTHEST]
    for start in starts:
        order = order[distances(points[order], start) > DISTANCE]
    while len(waiting := order[_matters(points[order], known) & ~known.explains(points[order])]):
        chosen, left = list[int](), waiting
        while len(left) and len(chosen) < AT_ONCE**2:
            chosen.append(int(left[0]))
            left = left[distances(points[left], points[left[0]]) > DISTANCE]
        before = dict(enumerate(len(of or ()) for of in known.origins))
        unknown = yield from explained(points[chosen], known, allowed, keep, origins=True, every=False)
        for k, of in enumerate(known.origins):
            old = before.get(k, 0)
            known.origins[k] = None if of is None else of[:old] + [len(starts) + chosen[one] for one in of[old:]]
        if unknown:
            return len(waiting)
        for row in chosen:
            order = order[distances(points[order], points[row]) > DISTANCE]
    return 0


def _matters(points: Floats, known: Known) -> Bools:
    """Which points would add more than a little to the probability of the known modes, all as half-spaces."""
    from scipy import special

    whole = special.logsumexp(special.log_ndtr(-np.linalg.norm(known.designs, axis=1)))
    return np.asarray(special.log_ndtr(-np.linalg.norm(points, axis=1)) > np.log(LARGE) + whole)


def explained(
    points: Floats, known: Known, allowed: Allowance, keep: int, origins: bool, every: bool | None = None
) -> Asking[int]:
    """Adds the modes of violations (k, n), in their order, until `keep` evaluations are left; how many have none then.

    Given violations are polished unless they are connected to a design point, and remembered as the origins of their
    modes. Others are passed over if they are beyond the tangent plane of a known mode, given ones too without `every`.
    """
    every = origins if every is None else every
    n = points.shape[1]
    waiting = np.arange(len(points))
    while True:
        beyond = waiting[~known.explains(points[waiting])]
        waiting = waiting if every else beyond
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
