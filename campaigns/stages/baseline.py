"""The baseline stage: the findings of an earlier run, evaluated on this model before anything is searched."""

from __future__ import annotations

from typing import ClassVar, Literal

from campaigns.asked.spec import Campaign
from campaigns.results.base import Described
from campaigns.results.stage import Reevaluated, StageResult
from campaigns.stages.declared import Declared


class BaselineResult(StageResult, Described):
    """The findings of the baseline on this model."""

    followed: ClassVar[bool] = True

    stage: Literal["baseline"] = "baseline"
    run: str
    """The baseline, as the campaign names it."""
    cases: list[Reevaluated]
    drawn_realisations: int = 0
    """How many of the first evaluations each simulated a noise seed of the baseline."""

    @property
    def drawn(self) -> int:
        return self.drawn_realisations

    @property
    def seeds(self) -> list[int]:
        """The noise seeds of the baseline's findings, in the order of their evaluations."""
        drawn = [(c.index, c.realisation) for c in self.cases if c.index is not None and c.realisation is not None]
        return [seed for _, seed in sorted(drawn)]

    @property
    def reevaluated(self) -> list[Reevaluated]:
        return self.cases


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    return [] if campaign.baseline is None else [(None, len(campaign.baseline.cases))]


def _description(campaign: Campaign) -> str:
    return "no baseline" if campaign.baseline is None else f"the findings of {campaign.baseline.run}"[:59]


stage = Declared(
    "baseline", 0.5, "Baseline", BaselineResult, _planned, _description, draws=lambda campaign, evaluations: 0
)
