"""The certify stage: an independent sample from the distributions, and a full grid if requested."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.sample import CertifyResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    # Excluded draws, which are repeated, are not included.
    certify = campaign.stages.certify
    if certify is None:
        return []
    grid = 0 if certify.grid is None else certify.grid.points ** len(campaign.uncertain)
    return [(None, certify.samples + grid)]


def _drawn(campaign: Campaign, evaluations: int) -> int:
    """At least the requested number is drawn before the grid begins; without noise a realisation has no effect."""
    certify = campaign.stages.certify
    return evaluations if certify is None or certify.grid is None else min(certify.samples, evaluations)


stage = Declared(
    kind="certify",
    order=3,
    title="Certify",
    result=CertifyResult,
    planned=_planned,
    description=lambda campaign: "independent sample",
    draws=_drawn,
    independent=True,
    against=True,
)
