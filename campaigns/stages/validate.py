"""The validate stage: distinguishes the worst cases and confirms each."""

from __future__ import annotations

from campaigns.asked.allowance import validation
from campaigns.asked.spec import Campaign
from campaigns.results.validate import ValidateResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    return [(None, validation(campaign, noisy=False).stored)]


def _again(campaign: Campaign) -> int:
    return validation(campaign).total - validation(campaign, noisy=False).stored


def _description(campaign: Campaign) -> str:
    return "each case evaluated again" if campaign.scenario is None else "half step, reference integrator"


stage = Declared(
    "validate", 4, "Validate", ValidateResult, _planned, _description, again=_again, against=True, of_findings=True
)
