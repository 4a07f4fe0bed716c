"""The estimate stage: P(violation) by importance sampling over the modes of the violations that the searches found."""

from __future__ import annotations

from typing import Literal

from campaigns.results.estimate import Estimation
from campaigns.results.stage import StageResult
from campaigns.sample_seed import SampleSeed
from campaigns.stages.declared import Declared


class EstimateResult(Estimation, StageResult):
    """P(violation) with its interval and modes, or why there is none."""

    stage: Literal["estimate"] = "estimate"

    @property
    def estimation(self) -> Estimation:
        return self

    @property
    def sample_seed(self) -> SampleSeed:
        return SampleSeed(self.seed, stated=not self.drawn_at_launch)


stage = Declared(
    kind="estimate",
    order=3.5,
    title="Estimate",
    result=EstimateResult,
    planned=lambda campaign: [(None, campaign.stages.estimate.evaluations)] if campaign.stages.estimate else [],
    description=lambda campaign: "P(violation) over its modes",
    against=True,
)
