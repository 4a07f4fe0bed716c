"""The largest ball around a point of the unit cube that contains no evaluation: its radius is the dispersion.

Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods (1992), section 6.1, with the Euclidean distance.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from backend.results.coverage.distances import Floats, nearest, squares

CANDIDATES = 4096
"""Random points that the search compares, besides corners of the cube."""
STARTS = 8
"""Of the random points, and of the corners, those farthest from every evaluation: from each an ascent begins."""
STEPS = 40
"""Of an ascent."""
CORNERS = 10
"""Up to so many parameters every corner is a candidate; above, as many at random."""


class Ball(NamedTuple):
    centre: Floats
    radius: float
    """Distance from the centre to the nearest evaluation: a larger ball may exist."""


def largest(points: Floats) -> Ball:
    """The largest ball that a deterministic search finds around a point of the cube; points: (m, n), at least one."""
    inner = np.random.default_rng(0).random((CANDIDATES, points.shape[1]))
    ends = _ascended(points, np.vstack([_farthest(points, inner), _farthest(points, _corners(inner))]))
    centre = ends[np.argmax(nearest(points, ends))]
    return Ball(centre, float(np.linalg.norm(points - centre, axis=1).min()))


def _corners(inner: Floats) -> Floats:
    n = inner.shape[1]
    return np.array(list(itertools.product((0.0, 1.0), repeat=n))) if n <= CORNERS else inner[: 2**CORNERS].round()


def _farthest(points: Floats, candidates: Floats) -> Floats:
    return candidates[np.argsort(-nearest(points, candidates), kind="stable")[:STARTS]]


def _ascended(points: Floats, starts: Floats) -> Floats:
    """The ends of ascents away from the nearest points; a step that fails is halved."""
    at = tried = starts
    best = np.full(len(starts), -1.0)
    step = np.sqrt(nearest(points, starts)) / 2
    for _ in range(STEPS):
        radius = nearest(points, tried)
        better = radius > best
        step = np.where(better, step, step / 2)
        at, best = np.where(better[:, None], tried, at), np.maximum(radius, best)
        tried = np.clip(at + step[:, None] * _directions(points, at, step), 0.0, 1.0)
    return at


def _directions(points: Floats, at: Floats, step: Floats) -> Floats:
    """Unit vectors away from all points that are nearest within about a step; at a face none leaves the cube.

    Away from the nearest alone would turn back and forth: at the largest ball several are equally near.
    """
    distance = np.sqrt(squares(points, at))
    beyond = distance - distance.min(axis=1, keepdims=True)
    weight = np.exp(-beyond / np.maximum(step, 1e-12)[:, None]) / np.maximum(distance, 1e-12)
    away = at * weight.sum(axis=1, keepdims=True) - weight @ points
    away[((at <= 0.0) & (away < 0.0)) | ((at >= 1.0) & (away > 0.0))] = 0.0
    return np.asarray(away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-12))
