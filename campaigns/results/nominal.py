"""The evaluation at the nominal values of the parameters."""

from __future__ import annotations

from typing import Annotated

from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Result, Status, Values
from campaigns.results.measured import Measured


class NominalCase(Result):
    """The evaluation at the nominal values."""

    cost: float | None
    """In the criterion's unit; null where it has none."""
    margin: float | None
    status: Status
    reason: str = ""
    """Why it has no cost."""
    parameters: Values = {}
    measured: Annotated[Measured | None, UNLESS_NONE] = None
    """Of a simulator; omitted for a closed loop, which repeats by construction."""
