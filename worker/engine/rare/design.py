"""Design points: of every mode the violation nearest to the origin, where its density is highest.

Hasofer and Lind, Exact and invariant second-moment code format (J. Eng. Mech. Div. 100, 1974); the step is that of
Rackwitz and Fiessler, Structural reliability under combined random load sequences (Computers & Structures 9, 1978),
with the last few linearised limit states instead of one: a violation may take several conditions at once.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from worker.engine.rare.evaluated import Allowance, Asking, Evaluated, Floats, evaluated

STEP = 0.1
"""Of a finite difference, in standard deviations: wider than the ripple of a closed loop's cost."""
GRID, LAST_GRID = (5, 4, 4), (4, 4)
"""Points between the last safe and the first violating one on a ray; each stage refines the one before."""
STEPS = 7
"""At most; a point that three times comes no closer ends."""
CUTS = 3
NULL_STEP = 0.4
REACH = 10.0
"""Farther from the origin nothing matters: the probability beyond is below 1e-23."""
IDLE, CONVERGED = 3, 0.985
DEEPER = 1.05
"""A violation so much farther on its ray that has the value of the first one there shows that there is no slope."""
PARTS, RADII = np.array([1.0, 0.4, 0.1]), np.array([1.0, 1.03, 1.1])
"""Of a step towards the projection, and of the distance to the origin there."""


class Cut(NamedTuple):
    """A linearised limit state: points u with slope . u >= least violate."""

    slope: Floats
    least: float


def cost(dimension: int) -> int:
    """Evaluations that one polished point takes at most; one without a slope takes fewer."""
    return sum(GRID) + 2 + STEPS * (1 + dimension + 2 * len(PARTS) * len(RADII)) + sum(LAST_GRID)


def polished(points: Floats, allowed: Allowance) -> Asking[tuple[Floats, Floats]]:
    """The design points (k, n) reached from violations (k, n), and the slopes there; every one violates."""
    found = yield from nearest_on_rays(points, allowed)
    near = yield from evaluated(found, allowed)
    deep = yield from evaluated(DEEPER * points, allowed)
    flat = (near.margins == deep.margins) | (np.isnan(near.margins) & np.isnan(deep.margins))
    query, idle = found.copy(), np.where(flat, IDLE, 0)
    cuts: list[list[Cut]] = [[] for _ in found]
    for _ in range(STEPS):
        rows = np.flatnonzero(idle < IDLE)
        if not len(rows):
            break
        here = yield from evaluated(query[rows], allowed)
        slopes = yield from gradients(here, allowed)
        for row, cut in zip(rows, linearised(here, slopes), strict=True):
            cuts[row] = [*cuts[row], cut][-CUTS:] if cut else cuts[row]
        targets = np.array([[target(cuts[row][-1:], query[row]), target(cuts[row], query[row])] for row in rows])
        closer = yield from _closer(found[rows], targets, allowed)
        lengths = np.linalg.norm(found[rows], axis=1)
        gained = np.linalg.norm(closer, axis=1) < 0.995 * lengths
        ended = np.linalg.norm(targets[:, 1], axis=1) > CONVERGED * lengths
        idle[rows] = np.where(ended, IDLE, np.where(gained, 0, idle[rows] + 1))
        found[rows] = closer
        # What ends a step is linearised where it has begun to be safe.
        query[rows] = np.where(gained[:, None], closer, closer + NULL_STEP * (targets[:, 1] - closer))
    slopes = np.array([-own[-1].slope if own else np.zeros(points.shape[1]) for own in cuts])
    found[flat] = yield from _one_by_one(found[flat], allowed)
    return (yield from nearest_on_rays(found, allowed, LAST_GRID)), slopes


def _one_by_one(points: Floats, allowed: Allowance) -> Asking[Floats]:
    """Violations with every coordinate in turn as near to 0 as violates: where no slope shows which one decides."""
    found = points.copy()
    for i in range(points.shape[1]):
        without = found.copy()
        without[:, i] = 0.0
        found = yield from nearest_on_rays(found, allowed, LAST_GRID, without)
    return found


def nearest_on_rays(
    points: Floats, allowed: Allowance, grid: tuple[int, ...] = GRID, origins: Floats | None = None
) -> Asking[Floats]:
    """The first violations on the segments from the origin, or other places, to violations, to a hundredth of the
    length."""
    begin = np.zeros_like(points) if origins is None else origins
    low, high = np.zeros(len(points)), np.ones(len(points))
    for count in grid:
        parts = np.linspace(low, high, count + 2)[1:-1]
        tried = begin + parts[:, :, None] * (points - begin)
        seen = yield from evaluated(tried.reshape(-1, points.shape[1]), allowed)
        violates = np.vstack([seen.violates.reshape(count, -1), np.ones(len(points), dtype=bool)])
        first, ends = violates.argmax(axis=0), np.vstack([low, parts, high])
        low, high = ends[first, np.arange(len(points))], ends[first + 1, np.arange(len(points))]
    return np.asarray(begin + high[:, None] * (points - begin))


def gradients(here: Evaluated, allowed: Allowance) -> Asking[Floats]:
    """Forward differences (k, n); zero where an evaluation has no cost."""
    k, n = here.points.shape
    beside = (here.points[:, None, :] + STEP * np.eye(n)).reshape(-1, n)
    seen = yield from evaluated(beside, allowed)
    return np.nan_to_num((seen.margins.reshape(k, n) - here.margins[:, None]) / STEP)


def linearised(here: Evaluated, slopes: Floats) -> list[Cut | None]:
    """The linearised limit state at each point; None where there is no slope."""
    least = np.nan_to_num(here.margins) - np.sum(slopes * here.points, axis=1)
    return [Cut(-s, float(b)) if s @ s > 1e-12 else None for s, b in zip(slopes, least, strict=True)]


def projected(cuts: list[Cut]) -> Floats | None:
    """The point nearest to the origin that satisfies all cuts; None if no subset of them gives one."""
    slopes, least = np.array([cut.slope for cut in cuts]), np.array([cut.least for cut in cuts])
    found: list[Floats] = []
    for size in range(1, len(cuts) + 1):
        for chosen in map(list, combinations(range(len(cuts)), size)):
            a = slopes[chosen]
            point = a.T @ np.linalg.lstsq(a @ a.T, least[chosen], rcond=1e-9)[0]
            if (slopes @ point >= least - 1e-6 * np.linalg.norm(slopes, axis=1)).all():
                found.append(point)
    return min(found, key=lambda point: float(point @ point), default=None)


def target(cuts: list[Cut], here: Floats) -> Floats:
    """The point to which a step leads, within the reach; the point itself if the cuts lead nowhere."""
    point = projected(cuts) if cuts else None
    return here if point is None else point * min(1.0, REACH / max(float(np.linalg.norm(point)), 1e-300))


def _closer(found: Floats, targets: Floats, allowed: Allowance) -> Asking[Floats]:
    """The violations nearest to the origin between points (k, n) and targets (k, 2, n); the points if there are
    none."""
    k, n = found.shape
    steps = PARTS[:, None, None, None] * (targets - found[:, None, :])
    tried = (RADII[:, None, None, None, None] * (found[:, None, :] + steps)).swapaxes(2, 3).reshape(-1, k, n)
    different, which = np.unique(tried.reshape(-1, n), axis=0, return_inverse=True)
    seen = yield from evaluated(different, allowed)
    lengths = np.where(seen.violates, np.linalg.norm(different, axis=1), np.inf)[which].reshape(-1, k)
    best = tried[lengths.argmin(axis=0), np.arange(k)]
    better = lengths.min(axis=0) < np.linalg.norm(found, axis=1)
    return np.where(better[:, None], best, found)
