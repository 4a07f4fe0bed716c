"""The violations that a search leaves of a problem: the ends of local descents of its cost, within six deviations."""

from __future__ import annotations

import numpy as np
from scipy import optimize
from scipy.stats import qmc

from tests.bench.rare.problem import Floats, Problem

WIDE, DESCENTS = 6.0, 24


def starts(problem: Problem) -> Floats:
    """Distinct violations (k, n), the lowest first. Of a generated problem they are known."""
    if problem.modes:
        return np.array([mode.start for mode in problem.modes])
    n = problem.dimension
    points = WIDE * (2.0 * qmc.Sobol(n, seed=1).random(512) - 1.0)
    lowest = points[np.argsort(problem.costs(points), kind="stable")]
    found: list[tuple[float, Floats]] = []
    for start in np.vstack([lowest[: DESCENTS // 2], points[: DESCENTS // 2]]):
        end = optimize.minimize(
            lambda u: float(problem.costs(u[None])[0]), start, method="L-BFGS-B", bounds=[(-WIDE, WIDE)] * n
        )
        if end.fun <= 0.0 and all(np.linalg.norm(end.x - other) > 0.03 * 2.0 * WIDE for _, other in found):
            found.append((float(end.fun), end.x))
    return np.array([point for _, point in sorted(found, key=lambda pair: pair[0])])
