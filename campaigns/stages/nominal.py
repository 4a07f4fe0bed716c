"""The nominal stage: one evaluation with every parameter at its nominal value.

Of a simulator, this and further points are evaluated several times, to measure whether results repeat.
"""

from __future__ import annotations

from typing import Literal

from campaigns.results.base import Untraced
from campaigns.results.measured import Measured
from campaigns.results.nominal import NominalCase
from campaigns.results.stage import StageResult
from campaigns.stages.declared import Declared

POINTS, TIMES = 5, 3
"""Of a simulator: how many points are evaluated, and how often each."""


class NominalResult(NominalCase, StageResult):
    """The evaluation at the nominal values."""

    stage: Literal["nominal"] = "nominal"
    untraced: Untraced = {}

    @property
    def at_nominal(self) -> NominalCase:
        return self

    @property
    def repeatability(self) -> Measured | None:
        return self.measured


stage = Declared(
    kind="nominal",
    order=0,
    title="Nominal",
    result=NominalResult,
    planned=lambda campaign: [(None, POINTS * TIMES if campaign.simulator else 1)],
    description=lambda campaign: "nominal values, repeatability" if campaign.simulator else "every parameter nominal",
    again=lambda campaign: 1,  # its trace
    against=True,
)
