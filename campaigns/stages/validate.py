"""The validate stage: distinguishes the worst cases and confirms each."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.validate import ValidateResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    # An estimate: the usual number to distinguish the worst cases (measured on the library), plus one's neighbours.
    usual = 400 * (len(campaign.uncertain) + 1)
    return [(None, min(campaign.stages.findings.evaluations, usual) + campaign.stages.validate_.neighbours)]


def _description(campaign: Campaign) -> str:
    return "each case evaluated again" if campaign.scenario is None else "half step, reference integrator"


stage = Declared("validate", 4, "Validate", ValidateResult, _planned, _description, of_findings=True)
