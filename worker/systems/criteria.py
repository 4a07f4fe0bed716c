"""The criteria of a problem as results name them, and their values in their own sign. Start reading at `criteria`."""

from __future__ import annotations

import numpy as np

from campaigns.results.search import FrontCriterion
from worker.systems.problem import Floats, Problem


def criteria(problem: Problem) -> list[FrontCriterion]:
    """The criteria in the order of the costs' columns, the one that decides first; each name once."""
    found: list[FrontCriterion] = []
    for criterion in problem.criteria:
        alike = sum(c.name.partition("#")[0] == criterion.name for c in found)
        name = f"{criterion.name}#{alike + 1}" if alike else criterion.name
        found.append(
            FrontCriterion(
                name=name,
                title=criterion.title,
                quantity=criterion.quantity,
                unit=criterion.unit,
                worse=criterion.worse,
            )
        )
    return found


def values(problem: Problem, costs: Floats) -> Floats:
    """Costs (m, k), all of them lower when worse, as the criteria's values in their own sign."""
    return np.stack([0.0 - c if k.worse == "high" else c for c, k in zip(costs.T, problem.criteria, strict=True)], 1)
