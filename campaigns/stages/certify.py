"""The certify stage: an independent sample from the distributions, and a full grid if requested."""

from __future__ import annotations

from typing import Literal

from campaigns.asked.spec import Campaign
from campaigns.limits import DRAWS
from campaigns.results.base import Stop
from campaigns.results.sample import FAILURES, FIRST, KEPT, Blocks, Certificate, GridResult
from campaigns.results.stage import StageResult
from campaigns.sample_seed import SampleSeed
from campaigns.stages.declared import Declared


class CertifyResult(Certificate, StageResult):
    """The sample that supports a claim on probability, and the grid if requested."""

    stage: Literal["certify"] = "certify"
    grid: GridResult | None
    drawn_realisations: int = 0
    """How many of the stage's first evaluations each drew their own noise realisation."""
    evaluations: int = 0
    failed: int = 0
    excluded: int = 0
    seconds: float = 0.0
    stop: Stop | None = None
    flights: list[int] | None = None
    """Of a sample of which only the lowest are stored: the indices of its evaluations among all draws."""
    realisations: list[int] | None = None
    """The noise seeds of these."""
    blocks: Blocks | None = None

    @property
    def certificate(self) -> Certificate:
        return self

    @property
    def drawn(self) -> int:
        return self.drawn_realisations

    @property
    def seeds(self) -> list[int] | None:
        return self.realisations

    @property
    def counted(self) -> Blocks | None:
        return self.blocks

    @property
    def sample_seed(self) -> SampleSeed | None:
        return None if self.seed is None else SampleSeed(self.seed, stated=not self.drawn_at_launch)

    @property
    def ended(self) -> Stop | None:
        return self.stop


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    # Excluded draws, which are repeated, are not included.
    certify = campaign.stages.certify
    if certify is None:
        return []
    grid = 0 if certify.grid is None else certify.grid.points ** len(campaign.uncertain)
    return [(None, certify.samples + grid)]


def _most(campaign: Campaign, planned: int) -> int:
    """The evaluations stored at most, with those drawn again in place of excluded ones."""
    certify = campaign.stages.certify
    if certify is None:
        return planned
    drawn = planned + (DRAWS - 1) * certify.samples
    return min(KEPT + FAILURES + FIRST, drawn) if certify.keep == "lowest" else drawn


def _beyond(campaign: Campaign) -> int:
    """Every stored evaluation of a closed loop is simulated on beyond the horizon; draws that are not stored come in
    addition."""
    certify, planned = campaign.stages.certify, sum(planned for _, planned in _planned(campaign))
    counted = certify is not None and certify.keep == "lowest"
    onward = 0 if campaign.scenario is None else min(KEPT + FIRST, planned) if counted else planned
    return onward + (DRAWS * planned if counted else 0)


def _drawn(campaign: Campaign, evaluations: int) -> int:
    """The evaluations that are drawn: all requested ones precede the grid; without noise a realisation has no
    effect."""
    certify = campaign.stages.certify
    if certify is not None and certify.keep == "lowest":
        return 0  # its evaluations are stored with their seeds, when it ends
    return evaluations if certify is None or certify.grid is None else min(certify.samples, evaluations)


stage = Declared(
    kind="certify",
    order=3,
    title="Certify",
    result=CertifyResult,
    planned=_planned,
    description=lambda campaign: "independent sample",
    most=_most,
    again=_beyond,
    draws=_drawn,
    partly=lambda campaign: campaign.stages.certify is not None and campaign.stages.certify.keep == "lowest",
    independent=True,
    redraws=True,
    against=True,
)
