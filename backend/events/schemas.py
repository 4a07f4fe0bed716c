"""The content of the event stream besides run summaries and stages."""

from __future__ import annotations

from backend.http.schema import Schema


class NewImprovements(Schema):
    """Improvements of one stage, as columns of equal length, to be appended by index to those already received.

    The first event after connecting has all of them, later ones only the new ones.
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
