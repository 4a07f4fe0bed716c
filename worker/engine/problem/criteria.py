"""The criteria of a problem as results store them, and their values in their own sign."""

from __future__ import annotations

from campaigns.results.search import FrontCriterion
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Floats, in_own_sign


def criteria(problem: Problem) -> list[FrontCriterion]:
    """The criteria in the order of the cost columns, the deciding one first; names are unique."""
    return [
        FrontCriterion(name=r.name, title=r.title, quantity=r.quantity, unit=r.unit, worse=r.worse)
        for r in problem.results
    ]


def values(problem: Problem, costs: Floats) -> Floats:
    """Costs (m, k), where lower is worse, as the criteria's values in their own sign."""
    return in_own_sign(problem.results, costs)
