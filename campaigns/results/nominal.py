"""The result of the nominal stage."""

from __future__ import annotations

from typing import Annotated, Literal

from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Status, Untraced, Values
from campaigns.results.measured import Measured
from campaigns.results.stage import StageResult


class NominalResult(StageResult):
    """The evaluation at the nominal values."""

    stage: Literal["nominal"] = "nominal"
    cost: float | None
    """In the criterion's unit; null where it has none."""
    margin: float | None
    status: Status
    reason: str = ""
    """Why it has no cost."""
    parameters: Values = {}
    measured: Annotated[Measured | None, UNLESS_NONE] = None
    """Of a simulator; omitted for a closed loop, which repeats by construction."""
    untraced: Untraced = {}

    @property
    def repeatability(self) -> Measured | None:
        return self.measured
