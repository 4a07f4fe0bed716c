"""The content of the event stream besides run summaries and stages. Start reading at `NewImprovements`."""

from __future__ import annotations

from backend.http.schema import Schema


class NewImprovements(Schema):
    """Evaluations of one stage that became its best so far; equal columns, to be appended to those known by index.

    The first event after connecting has them all, a later one those since the event before.
    """

    index: list[int]
    seconds: list[float]
    cost: list[float]
    evaluations: int
    """The total number of evaluations of the stage."""
    elapsed: float
    """Working time of the stage at the last of them [s]."""
    parameters: dict[str, float]
    """The parameters of the last of these improvements, {path: value} in their units; empty if there is none."""
