"""The Pareto front of several criteria: the evaluations that no other evaluation dominates.

Pareto dominance, as Deb et al., NSGA-II (IEEE Transactions on Evolutionary Computation 6, 2002) sort by it, over all
evaluations of a stage, whatever its method.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from campaigns import thin
from campaigns.results.base import OK
from campaigns.results.search import FrontCriterion, FrontPoint
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Floats, in_own_sign

MOST = 2000
"""Points of a front that a result stores at most, spread evenly over the values of the first criterion."""


def criteria(problem: Problem) -> list[FrontCriterion]:
    """The criteria in the order of the cost columns, the deciding one first; names are unique."""
    return [FrontCriterion(**vars(result)) for result in problem.results]


def undominated(costs: Floats) -> NDArray[np.int64]:
    """The rows (m, k) that no other row dominates, in ascending order of the first cost.

    Of equal rows the first one.
    """
    order = np.lexsort((np.arange(len(costs)), *costs.T[::-1]))
    left, front = order, []
    # Once sorted, a row is never dominated by a later one: the first remaining row belongs to the front.
    while len(left):
        front.append(left[0])
        left = left[(costs[left] < costs[left[0]]).any(axis=1)]
    return np.array(front, dtype=np.int64)


def of_stage(problem: Problem, columns: Columns | None) -> tuple[list[FrontPoint] | None, int | None]:
    """The Pareto front of a stage's evaluations, thinned, and its size; None with one criterion."""
    if columns is None or len(problem.results) == 1:
        return None, None
    ok = np.flatnonzero(columns.status == OK)
    rows = ok[undominated(columns.costs[ok])]
    size = len(rows)
    rows = rows[thin.even(size, MOST)]
    names = [result.name for result in problem.results]
    shown = in_own_sign(problem.results, columns.costs[rows])
    return [
        FrontPoint(
            index=int(row),
            parameters=problem.named(columns.points[row]),
            values=dict(zip(names, map(float, value), strict=True)),
        )
        for row, value in zip(rows, shown, strict=True)
    ], size
