"""The largest ball around a point of the unit cube that contains no evaluation: its radius is the dispersion.

Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods (1992), section 6.1, with the Euclidean distance.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from backend.results.coverage.tree import Floats, affordable, near, nearest, tree_of

if TYPE_CHECKING:
    from scipy.spatial import KDTree

STARTS = 8
"""Of random points, and of corners, those farthest from every evaluation: from each an ascent begins."""
STEPS = 40
"""Of an ascent."""


class Ball(NamedTuple):
    centre: Floats
    radius: float
    """Distance from the centre to the nearest evaluation: a larger ball may exist."""


def largest(points: Floats) -> Ball:
    """The largest ball that a deterministic search finds around a point of the cube; points: (m, n), at least one."""
    tree, count = tree_of(points), affordable(points.shape[1])
    inner = np.random.default_rng(0).random((count, points.shape[1]))
    starts = np.vstack([_farthest(tree, inner), _farthest(tree, _corners(inner))])
    ends = _ascended(points, tree, starts)
    centre = ends[np.argmax(nearest(tree, ends))]
    return Ball(centre, float(np.linalg.norm(points - centre, axis=1).min()))


def _corners(inner: Floats) -> Floats:
    """All corners, or as many at random as there are random points."""
    count, n = inner.shape
    return np.array(list(itertools.product((0.0, 1.0), repeat=n))) if 2**n <= count else inner.round()


def _farthest(tree: KDTree, candidates: Floats) -> Floats:
    return candidates[np.argsort(-nearest(tree, candidates), kind="stable")[:STARTS]]


def _ascended(points: Floats, tree: KDTree, starts: Floats) -> Floats:
    """The ends of ascents away from the nearest points; a step that fails is halved."""
    most = 2 * starts.shape[1] + 2
    at, (distance, row) = starts, near(tree, starts, most)
    step = distance[:, 0] / 2
    for _ in range(STEPS):
        away = _directions(at[:, None, :] - points[row], distance, at, step)
        tried = np.clip(at + step[:, None] * away, 0.0, 1.0)
        farther, rows = near(tree, tried, most)
        better = farther[:, :1] > distance[:, :1]
        step = np.where(better[:, 0], step, step / 2)
        at, distance = np.where(better, tried, at), np.where(better, farther, distance)
        row = np.where(better, rows, row)
    return at


def _directions(apart: Floats, distance: Floats, at: Floats, step: Floats) -> Floats:
    """Unit vectors away from the points that are nearest within about a step; at a face none leaves the cube.

    Away from the nearest alone would turn back and forth: at the largest ball several are equally near.
    apart: vectors from the nearest points (m, k, n), `distance` long (m, k).
    """
    weight = np.exp((distance[:, :1] - distance) / np.maximum(step, 1e-12)[:, None]) / np.maximum(distance, 1e-12)
    away = (weight[:, :, None] * apart).sum(axis=1)
    away[((at <= 0.0) & (away < 0.0)) | ((at >= 1.0) & (away > 0.0))] = 0.0
    return np.asarray(away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-12))
