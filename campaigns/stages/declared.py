"""The declaration of a kind of stage."""

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
    """For every stage of this kind in the campaign: the method, if any, and the budget of evaluations."""
    description: Callable[[Campaign], str]
    """A short description of the stages of this kind in this campaign."""
