"""The criteria of a problem as results name them, and their values in their own sign. Start reading at `criteria`."""

from __future__ import annotations

from campaigns.results.search import FrontCriterion
from worker.problem.problem import Problem
from worker.systems.base import Floats, in_own_sign


def criteria(problem: Problem) -> list[FrontCriterion]:
    """The criteria in the order of the costs' columns, the one that decides first; each name once."""
    return [
        FrontCriterion(name=r.name, title=r.title, quantity=r.quantity, unit=r.unit, worse=r.worse)
        for r in problem.results
    ]


def values(problem: Problem, costs: Floats) -> Floats:
    """Costs (m, k), all of them lower when worse, as the criteria's values in their own sign."""
    return in_own_sign(problem.results, costs)
