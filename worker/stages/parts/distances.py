"""What a verdict has to state of its distances: which point of the obstacles they end at.

Start reading at `clause`.
"""

from __future__ import annotations

from campaigns.asked import extents
from campaigns.asked.check import parameters
from campaigns.wording import listed, number
from worker.catalogue.installed import catalogue
from worker.systems.problem import Problem


def clause(problem: Problem) -> str:
    """The condition on distances for the scope of a verdict, as a clause; empty for a criterion that reads none."""
    criterion = problem.parts.criterion
    if criterion.measured_to == "surface":
        return f"distances measured to the obstacles' surfaces{_less(problem)}"
    if criterion.measured_to != "centre":
        return ""
    inside = _inside(problem)
    more = f"; a vehicle inside {listed(list(inside))} may count as clear" if inside else ""
    return f"distances measured to the obstacles' centres, not their surfaces{more}"


def overlooked(problem: Problem) -> str:
    """Why such distances bar "cleared", as a sentence; empty where they do not.

    That is where the threshold is not within an obstacle, or the campaign states that a centre distance is meant. New
    campaigns of that kind are refused; one that was queued or run before they were is not.
    """
    if problem.parts.criterion.measured_to != "centre" or problem.campaign.criterion.from_centre:
        return ""
    inside = _inside(problem)
    if not inside:
        return ""
    path = max(inside, key=lambda p: inside[p])
    return (
        f"{problem.parts.criterion.quantity} is measured to the obstacles' centres, and the threshold of "
        f"{number(problem.threshold)} m is within {path}, which reaches {number(inside[path])} m from its own: "
        "a vehicle inside it would count as clear"
    )


def _inside(problem: Problem) -> dict[str, float]:
    described = catalogue()
    return extents.within(problem.campaign, described, parameters(problem.campaign, described))


def _less(problem: Problem) -> str:
    """What is subtracted for the vehicle's own body; an uncertain radius stands with its bounds in the scope."""
    path = "criterion.body_radius"
    if path not in problem.paths:
        return ""
    body = float(problem.nominal[problem.paths[path]])
    if path in problem.campaign.uncertain:
        return f", less {path}"
    return f", less the radius of the vehicle's body of {number(body)} m" if body > 0 else ""
