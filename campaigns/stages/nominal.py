"""The nominal stage: one evaluation with every parameter at its nominal value.

Of a simulator, this and further points are evaluated several times, to measure whether results repeat.
"""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.nominal import NominalResult
from campaigns.stages.declared import Declared

POINTS, TIMES = 5, 3
"""Of a simulator: how many points are evaluated, and how often each."""


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    return [(None, 1 if campaign.simulator is None else POINTS * TIMES)]


def _description(campaign: Campaign) -> str:
    return "every parameter nominal" if campaign.simulator is None else "nominal values, repeatability"


stage = Declared(
    kind="nominal",
    order=0,
    title="Nominal",
    result=NominalResult,
    planned=_planned,
    description=_description,
    again=lambda campaign: 1,  # its trace
)
