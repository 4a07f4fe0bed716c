"""Slices: each parameter over its bounds with the others fixed, through the nominal point or a worst case."""

from __future__ import annotations

from collections.abc import Generator
from itertools import pairwise

import numpy as np

from campaigns.results.base import STATUS
from campaigns.results.slices import Curve, Slices
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.systems.base import Floats

POINTS = 41
"""Points on each slice through a worst case, besides the worst case itself."""

Curves = Generator[Floats, Batch, list[Curve]]
"""Yields points (m, n), receives their batch, returns the curves."""


def curves(problem: Problem, point: Floats, count: int) -> Curves:
    """`count` values of each parameter in turn, in one batch; the others as in `point` (n,)."""
    return _through(problem, point, [np.linspace(0.0, 1.0, count)] * problem.dimension)


def slices(problem: Problem, point: Floats, count: int = POINTS) -> Generator[Floats, Batch, Slices]:
    """Curves that pass through the point itself."""
    even = np.linspace(0.0, 1.0, count)
    found = yield from _through(problem, point, [np.union1d(even, [u]) for u in point])
    return Slices(curves=found, at=problem.named(point))


def _through(problem: Problem, point: Floats, axes: list[Floats]) -> Curves:
    points = np.repeat(point[None, :], sum(map(len, axes)), axis=0)
    ends = np.cumsum([0, *map(len, axes)])
    rows = [slice(first, last) for first, last in pairwise(ends)]
    for k, axis in enumerate(axes):
        points[rows[k], k] = axis
    batch = yield points
    values = problem.values(points)
    return [
        Curve(
            path=r.path,
            values=[float(v) for v in values[rows[k], k]],
            costs=[float(c) if np.isfinite(c) else None for c in batch.costs[rows[k], 0]],
            status=[STATUS[s] for s in batch.status[rows[k]]],
        )
        for k, r in enumerate(problem.ranges)
    ]
