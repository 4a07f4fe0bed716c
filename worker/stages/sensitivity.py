"""Sensitivity, one at a time: each parameter over its bounds, the others nominal.

Srikanthakumar, chapter 3: d_min against each parameter. It shows main effects near the nominal point and nothing of
interactions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from worker.search.base import STATUS
from worker.stages.base import Context, drive, once


def run(context: Context, position: int) -> dict[str, Any]:
    """One batch: `points` values of each parameter in turn."""
    problem, study = context.problem, context.campaign.stages.sensitivity
    assert study is not None
    grid = np.linspace(0.0, 1.0, study.points)
    points = np.repeat(problem.nominal_point[None, :], problem.dimension * study.points, axis=0)
    for k in range(problem.dimension):
        points[k * study.points : (k + 1) * study.points, k] = grid
    driven = drive(context, position, once(points, "flew every curve"), len(points))
    assert driven.columns is not None
    values = problem.values(points)
    curves = []
    for k, r in enumerate(problem.ranges):
        rows = slice(k * study.points, (k + 1) * study.points)
        costs = driven.columns.costs[rows, 0]
        curves.append(
            {
                "path": r.path,
                "values": [float(v) for v in values[rows, k]],
                "costs": [float(c) if np.isfinite(c) else None for c in costs],
                "status": [STATUS[s] for s in driven.columns.status[rows]],
            }
        )
    return {"points": study.points, "curves": curves}
