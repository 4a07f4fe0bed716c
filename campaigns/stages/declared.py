"""The declaration of a kind of stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from campaigns.asked.spec import Campaign
from campaigns.results.stage import StageResult


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
    most: Callable[[Campaign, int], int] = lambda campaign, planned: planned
    """How many evaluations a stage with this budget stores at most."""
    again: Callable[[Campaign], int] = lambda campaign: 0
    """How many more it makes at most without storing them: for traces, and to confirm results."""
    draws: Callable[[Campaign, int], int] | None = None
    """Of a stage whose evaluations may draw their own noise: how many of its first ones have surely drawn it when it
    has so many, before it has a result."""
    partly: Callable[[Campaign], bool] = lambda campaign: False
    """Whether it stores a part of its evaluations only: a continued run makes them again."""
    independent: bool = False
    """Whether it evaluates an independent sample of the distributions: of a simulator, each by one call."""
    redraws: bool = False
    """Whether it draws excluded samples again, so that these are no part of its budget."""
    against: bool = False
    """Whether its lowest evaluation counts against what other runs of the same question claim: it evaluates the
    campaign's own question, which the findings of a baseline need not be of."""
    of_findings: bool = False
    """Whether it evaluates around the findings of all stages before it, which are stored with its result: how often is
    not known before it ends, and a continued run evaluates there again."""
