"""What a kind of stage declares. Start reading at `Declared`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from campaigns.asked.spec import Campaign
from campaigns.results.base import StageResult


@dataclass(frozen=True)
class Declared:
    """A kind of stage, as a plan, the pages and the report need it."""

    kind: str
    order: float
    """Stages run from low to high."""
    title: str
    result: type[StageResult]
    planned: Callable[[Campaign], list[tuple[str | None, int]]]
    """For every stage of this kind that the campaign asks for: the method, if any, and the budget of evaluations."""
    description: Callable[[Campaign], str]
    """What the stages of this kind do in this campaign, in a few words."""
