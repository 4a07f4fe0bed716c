"""What validation may take, from the campaign alone: the stage receives it, and `campaigns.stages.plan` announces it.

Unless a campaign asks for more, as many evaluations as its searches: those that distinguish the worst cases, their
neighbours, slices and boundaries (stored), and those made again to confirm results (not stored).
"""

from __future__ import annotations

from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.limits import FINDINGS, SPOT_CHECKS, VIOLATIONS

SLICE = 42
"""Evaluations along each parameter through a worst case."""
RAY, RAYS = 34, 2
"""Evaluations along one ray to the boundary of a violation; rays per parameter, and one more to the worst case."""

STARTS, DESCENT, USUAL = 60, 5, 8
"""Points to descend from at most, and the gradients that a descent from one should be able to take; the usual number of
findings, beyond which there are proportionally more points."""
CASE = 3
"""Evaluations that confirm a case: of a closed loop at the campaign's step, at half of it and with the reference
integrator; of a simulator in a used process, in a fresh one, and with half the step if it has one."""
NOMINAL = 3
"""The nominal case of a closed loop: its trace, one without avoidance, one beyond the horizon."""
CALLED_AGAIN = 3
"""Of a simulator that does not repeat: violations that are called again as often as a finding."""


class Allowance(NamedTuple):
    """stored: evaluations that distinguish the worst cases, by descents from `starts` points; total: these and the ones
    made again."""

    stored: int
    total: int
    starts: int


class Evidence(NamedTuple):
    """Evaluations around one worst case: its neighbours and slices; those of a violation besides."""

    around: int
    boundary: int


def validation(campaign: Campaign, noisy: bool = True) -> Allowance:
    """The allowance of validation: never fewer evaluations than confirming the nominal case and one finding takes
    (`least`). Where the searches or the stated number are smaller, `least` is the bound, and the estimate states so.

    noisy: whether a simulator does not repeat, which is measured only by the first stage; it needs at most as many
    evaluations if it repeats.
    """
    findings, stated = campaign.stages.findings, campaign.stages.validate_.evaluations
    confirming, needed = _confirming(campaign, noisy), least(campaign, noisy)
    known = _known(campaign) * case(campaign, noisy)
    requested = findings.evaluations if findings.evaluations != FINDINGS else 0
    total = max(searches(campaign), requested) if stated is None else stated
    each = sum(evidence(campaign))
    most = findings.evaluations + 2 * findings.at_most * each
    total = max(needed, min(total, most + confirming + CASE * VIOLATIONS))
    stored = max(0, min(most, total - max(needed, min(confirming + known, total // 2))))
    descents = stored // (DESCENT * (len(campaign.uncertain) + 1))
    return Allowance(stored, total, min(per_finding(STARTS, findings.at_most), max(1, descents)))


def per_finding(usual: int, at_most: int) -> int:
    """The number of points for each finding: the usual one, proportionally more where more findings are listed."""
    return usual * max(at_most, USUAL) // USUAL


def searches(campaign: Campaign) -> int:
    """The budget of all searches."""
    return sum(search.evaluations for search in campaign.stages.search)


def evidence(campaign: Campaign) -> Evidence:
    """What is evaluated around each worst case."""
    return Evidence(campaign.stages.validate_.neighbours + SLICE * len(campaign.uncertain), boundary(campaign))


def boundary(campaign: Campaign) -> int:
    """What one worst case that violates adds, for the distance from the nominal case to the violation."""
    return 1 + RAY * (RAYS * len(campaign.uncertain) + 1)


def case(campaign: Campaign, noisy: bool) -> int:
    """Confirming a case; of a simulator that does not repeat, by independent calls."""
    return campaign.stages.validate_.repeats if noisy and campaign.scenario is None else CASE


def finding(campaign: Campaign, noisy: bool) -> int:
    """Confirming a finding, with its trace; of a closed loop also beyond the horizon."""
    return case(campaign, noisy) + _shown(campaign)


def least(campaign: Campaign, noisy: bool) -> int:
    """What is always confirmed: the nominal case and the worst finding; of a closed loop also the lowest evaluation
    with its own noise, of a simulator that does not repeat the best of every search. Violations that none of them
    represents have a trace."""
    flies = campaign.scenario is not None
    nominal = case(campaign, noisy) + (NOMINAL if flies else 0)
    others = finding(campaign, noisy) if flies else len(campaign.stages.search) * case(campaign, noisy) * noisy
    return nominal + finding(campaign, noisy) + others + _shown(campaign)


def _shown(campaign: Campaign) -> int:
    """The trace of a finding, and of a closed loop its flight beyond the horizon."""
    return 1 if campaign.scenario is None else 2


def _known(campaign: Campaign) -> int:
    """The violations of a baseline, which are confirmed if they are none here."""
    baseline, threshold = campaign.baseline, campaign.criterion.threshold
    return 0 if baseline is None else sum(baseline.violated(case, threshold) for case in baseline.cases)


def _confirming(campaign: Campaign, noisy: bool) -> int:
    """Confirming all findings and random evaluations; violations, of which one is enough, take what is left."""
    others = (campaign.stages.findings.at_most - 1) * finding(campaign, noisy)
    again = CALLED_AGAIN * case(campaign, noisy) if noisy and campaign.scenario is None else 0
    return least(campaign, noisy) + others + again + SPOT_CHECKS
