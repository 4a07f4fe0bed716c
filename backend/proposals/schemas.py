"""The API schemas of a proposal."""

from __future__ import annotations

from backend.http.schema import Schema
from campaigns.documents import JsonObject


class MeasuredCost(Schema):
    """What one call of a simulator took, as the first stage of a run measured it."""

    run: str
    """The newest run that measured it with the same declaration and files of the simulator."""
    seconds: float
    """[s], with `slots` calls side by side."""
    slots: int
    evaluations: int
    """Of that stage."""
    failed: int


class ProposedSearch(Schema):
    """A search as a campaign states it."""

    method: str
    evaluations: int
    options: JsonObject


class Proposal(Schema):
    """Search methods and budgets that fit a length of time.

    The other stages of a run, such as certify and validate, take evaluations in addition.
    """

    measured: MeasuredCost | None
    """None if no run has measured the simulator as it is now."""
    known: str
    """What is known of the time of an evaluation, a sentence: from which run, or why nothing is."""
    sentence: str
    """How many evaluations fit and what is proposed, or why nothing is; empty if nothing was measured."""
    searches: list[ProposedSearch]
    """Empty if nothing is proposed."""
    seconds: float | None
    """Estimated time of the proposed searches [s]; None without any."""
