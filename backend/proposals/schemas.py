"""The API schemas of a proposal."""

from __future__ import annotations

from backend.http.schema import Instant, Schema


class MeasuredCost(Schema):
    """What one call of a simulator took, as the first stage of a run or `clearance check-simulator` measured it."""

    run: str | None
    """The run, if it is the newest measurement with the same declaration and files of the simulator; null if that is
    one of `clearance check-simulator`."""
    source: str
    """Where the time is known from: the run, or the command with its machine and time."""
    at: Instant | None
    """When it was measured [s since 1970], of a run when that began; null if it is not known."""
    host: str
    """The machine on which the command ran; empty for a run."""
    seconds: float
    """[s], with `slots` calls side by side."""
    slots: int
    evaluations: int
    """Of the measurement."""
    failed: int


class ProposedSearch(Schema):
    """A search as a campaign states it."""

    method: str
    evaluations: int
    options: dict[str, object]


class Proposal(Schema):
    """Search methods and budgets that fit a length of time.

    The other stages of a run, such as certify and validate, take evaluations in addition.
    """

    measured: MeasuredCost | None
    """None if the simulator as it is now was never measured."""
    known: str
    """What is known of the time of an evaluation, a sentence: where from, or why nothing is."""
    sentence: str
    """How many evaluations fit and what is proposed, or why nothing is; empty if nothing was measured."""
    searches: list[ProposedSearch]
    """Empty if nothing is proposed."""
    seconds: float | None
    """Estimated time of the proposed searches [s]; None without any. With 5 to 16 evaluations side by side they take at
    least as long; no more than 16 are counted."""
