"""The attraction stage: a region of attraction of the closed loop about its trim, proved for its polynomial model."""

from __future__ import annotations

from typing import Literal

from campaigns.results.attraction import Attraction
from campaigns.results.stage import StageResult
from campaigns.stages.declared import Declared


class AttractionResult(Attraction, StageResult):
    """The region with its certificate, or why there is none."""

    stage: Literal["attraction"] = "attraction"

    @property
    def attraction(self) -> Attraction:
        return self


stage = Declared(
    kind="attraction",
    order=3.7,
    title="Attraction",
    result=AttractionResult,
    planned=lambda campaign: [] if campaign.stages.attraction is None else [(None, 0)],
    description=lambda campaign: "region of attraction about trim",
)
