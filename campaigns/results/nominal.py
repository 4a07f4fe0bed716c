"""The result of the nominal stage."""

from __future__ import annotations

from typing import Literal

from campaigns.results.base import StageResult, Status, Values


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
