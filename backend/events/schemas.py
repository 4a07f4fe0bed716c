"""What the stream of events carries beside run summaries and stages. Start reading at `NewImprovements`."""

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
    """How many evaluations the stage has flown in all."""
    elapsed: float
    """Working time of the stage at the last of them [s]."""
    parameters: dict[str, float]
    """Where the last of these improvements is, {path: value} in the parameters' units; empty where there is none."""
