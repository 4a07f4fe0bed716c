"""The certify stage: an independent sample from the distributions, and a full grid if requested."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.sample import CertifyResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    # Excluded draws, which are repeated, are not included.
    asked = campaign.stages.certify
    if asked is None:
        return []
    grid = 0 if asked.grid is None else asked.grid.points ** len(campaign.uncertain)
    return [(None, asked.samples + grid)]


stage = Declared("certify", 3, "Certify", CertifyResult, _planned, lambda campaign: "independent sample")
