"""The front of several criteria: the evaluations that no other one is worse than everywhere.

Pareto dominance, as Deb et al., NSGA-II (IEEE Transactions on Evolutionary Computation 6, 2002) sort by it, over all
evaluations of a stage, whatever its method. Start reading at `told`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from worker.search.base import OK
from worker.stages.parts.store import Columns
from worker.systems.problem import Floats, Problem

MOST = 2000
"""Points of a front that a result holds; of more, these are spread evenly over the values of the first criterion."""


def criteria(problem: Problem) -> list[dict[str, str]]:
    """The criteria in the order of the costs' columns, the one that decides first; each name once."""
    found: list[dict[str, str]] = []
    for criterion in problem.criteria:
        alike = sum(c["name"].partition("#")[0] == criterion.name for c in found)
        name = f"{criterion.name}#{alike + 1}" if alike else criterion.name
        told = {"title": criterion.title, "quantity": criterion.quantity, "unit": criterion.unit}
        found.append({"name": name, **told, "worse": criterion.worse})
    return found


def values(problem: Problem, costs: Floats) -> Floats:
    """Costs (m, k), all of them lower when worse, as the criteria's values in their own sign."""
    return np.stack([0.0 - c if k.worse == "high" else c for c, k in zip(costs.T, problem.criteria, strict=True)], 1)


def undominated(costs: Floats) -> NDArray[np.int64]:
    """The rows (m, k) that no other row is as low as everywhere and lower somewhere, the lowest first cost first.

    Of equal rows the first one.
    """
    order = np.lexsort((np.arange(len(costs)), *costs.T[::-1]))
    left, front = order, []
    # Sorted, a row is never bettered by one behind it: the first of what is left belongs to the front.
    while len(left):
        front.append(left[0])
        left = left[(costs[left] < costs[left[0]]).any(axis=1)]
    return np.array(front, dtype=np.int64)


def told(problem: Problem, columns: Columns | None) -> dict[str, Any]:
    """What a stage's result says: the criteria, and with several the front with its size; null with one."""
    result: dict[str, Any] = {"criteria": criteria(problem), "front": None, "front_size": None}
    if columns is None or len(problem.criteria) == 1:
        return result
    ok = np.flatnonzero(columns.status == OK)
    rows = ok[undominated(columns.costs[ok])]
    result["front_size"] = len(rows)
    if len(rows) > MOST:
        rows = rows[np.unique(np.linspace(0, len(rows) - 1, MOST).round().astype(np.int64))]
    names = [c["name"] for c in result["criteria"]]
    shown = values(problem, columns.costs[rows])
    result["front"] = [
        {
            "index": int(row),
            "parameters": problem.named(columns.points[row]),
            "values": dict(zip(names, map(float, value), strict=True)),
        }
        for row, value in zip(rows, shown, strict=True)
    ]
    return result
