"""The criteria of a problem as results name them, and their values in their own sign. Start reading at `criteria`."""

from __future__ import annotations

import numpy as np

from campaigns.asked.criteria import named
from campaigns.results.search import FrontCriterion
from worker.systems.problem import Floats, Problem


def criteria(problem: Problem) -> list[FrontCriterion]:
    """The criteria in the order of the costs' columns, the one that decides first; each name once."""
    names = named(criterion.name for criterion in problem.criteria)
    return [
        FrontCriterion(
            name=name,
            title=criterion.title,
            quantity=criterion.quantity,
            unit=criterion.unit,
            worse=criterion.worse,
        )
        for name, criterion in zip(names, problem.criteria, strict=True)
    ]


def values(problem: Problem, costs: Floats) -> Floats:
    """Costs (m, k), all of them lower when worse, as the criteria's values in their own sign."""
    return np.stack([0.0 - c if k.worse == "high" else c for c, k in zip(costs.T, problem.criteria, strict=True)], 1)
