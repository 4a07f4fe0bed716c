"""What validation may take, from the campaign alone: the stage receives it, and `campaigns.stages.plan` announces it.

Unless a campaign asks for more, as many evaluations as its searches: those that distinguish the worst cases, their
neighbours, slices and boundaries (stored), and those made again to confirm results (not stored).
"""

from __future__ import annotations

from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.limits import SPOT_CHECKS, VIOLATIONS

USUAL = 20_000
"""Evaluations that distinguish the worst cases where nothing is stated, if the searches have more."""
SLICE = 42
"""Evaluations along each parameter through a worst case."""
RAY, RAYS = 34, 2
"""Evaluations along one ray to the boundary of a violation; rays per parameter, and one more to the worst case."""

STARTS, DESCENT = 60, 15
"""Points to descend from at most, and the gradients of a usual descent."""
CASE = 3
"""Evaluations that confirm a case: of a closed loop at the campaign's step, at half of it and with the reference
integrator; of a simulator in a used process, in a fresh one, and with half the step if it has one."""
UNREPRESENTED = 2
"""Findings that no search has polished: the lowest violation, and the lowest evaluation with its own noise."""
CALLED_AGAIN = 3
"""Of a simulator that does not repeat: violations that are called again as often as a finding."""


class Allowance(NamedTuple):
    """stored: evaluations that distinguish the worst cases, by descents from `starts` points; total: these and the ones
    made again."""

    stored: int
    total: int
    starts: int


def validation(campaign: Campaign) -> Allowance:
    """At most so many evaluations. Small budgets are exceeded by what confirms the nominal case and one finding."""
    findings, stated = campaign.stages.findings, campaign.stages.validate_.evaluations
    if stated is None:
        each = campaign.stages.validate_.neighbours + SLICE * len(campaign.uncertain) + boundary(campaign)
        wanted = USUAL if findings.evaluations is None else findings.evaluations
        stored = wanted + 2 * findings.at_most * each
        total = stored + _confirming(campaign) + CASE * VIOLATIONS
        if findings.evaluations is not None or total <= searches(campaign):
            return Allowance(stored, total, STARTS)
    total = searches(campaign) if stated is None else stated
    stored = total - min(_confirming(campaign), total // 2)
    descent = DESCENT * (len(campaign.uncertain) + 1)
    return Allowance(stored, max(total, stored + least(campaign)), min(STARTS, max(1, stored // descent)))


def searches(campaign: Campaign) -> int:
    """The budget of all searches."""
    return sum(search.evaluations for search in campaign.stages.search)


def boundary(campaign: Campaign) -> int:
    """What one worst case that violates adds, for the distance from the nominal case to the violation."""
    return 1 + RAY * (RAYS * len(campaign.uncertain) + 1)


def nominal(campaign: Campaign) -> int:
    """Confirming the nominal case: of a closed loop also its trace, one without avoidance, one beyond the horizon."""
    return case(campaign) + (0 if campaign.scenario is None else 3)


def finding(campaign: Campaign) -> int:
    """Confirming a finding, with its trace; of a closed loop also beyond the horizon."""
    return case(campaign) + shown(campaign)


def shown(campaign: Campaign) -> int:
    """The trace of a finding, and of a closed loop its flight beyond the horizon."""
    return 1 if campaign.scenario is None else 2


def case(campaign: Campaign) -> int:
    """Confirming a case: by independent calls if a simulator does not repeat, which is measured only later."""
    return CASE if campaign.scenario is not None else max(CASE, campaign.stages.validate_.repeats)


def incumbents(campaign: Campaign) -> int:
    """Calling the best of every search again, of a simulator that does not repeat."""
    return 0 if campaign.scenario is not None else len(campaign.stages.search) * case(campaign)


def least(campaign: Campaign) -> int:
    """What is always confirmed: the nominal case, the worst one, the best of the searches, and what none polished."""
    return nominal(campaign) + incumbents(campaign) + (1 + UNREPRESENTED) * finding(campaign)


def _confirming(campaign: Campaign) -> int:
    """Confirming all findings and random evaluations; violations, of which one is enough, take what is left."""
    others = (campaign.stages.findings.at_most - 1) * finding(campaign)
    again = 0 if campaign.scenario is not None else CALLED_AGAIN * case(campaign)
    return least(campaign) + others + again + SPOT_CHECKS
