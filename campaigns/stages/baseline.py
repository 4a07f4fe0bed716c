"""The baseline stage: the findings of an earlier run, evaluated on this model before anything is searched."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.baseline import BaselineResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    return [] if campaign.baseline is None else [(None, len(campaign.baseline.cases))]


def _description(campaign: Campaign) -> str:
    return "no baseline" if campaign.baseline is None else f"the findings of {campaign.baseline.run}"[:59]


stage = Declared("baseline", 0.5, "Baseline", BaselineResult, _planned, _description)
