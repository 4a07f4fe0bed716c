"""The result of the baseline stage: what the findings of the baseline cost on this model."""

from __future__ import annotations

from typing import ClassVar, Literal

from campaigns.results.base import Described, Result, StageResult, Status, Values


class Reevaluated(Result):
    """One finding of the baseline, evaluated on this model."""

    label: str
    """Of the baseline."""
    index: int | None
    """Of its evaluation in this stage; null if it could not be evaluated."""
    parameters: Values = {}
    """As evaluated; of one that was not evaluated, as the baseline has them."""
    point: list[float] = []
    """On the unit cube of this campaign; empty if it was not evaluated."""
    status: Status | None = None
    cost: float | None = None
    reason: str = ""
    """Why it was not evaluated, or has no cost."""
    assumed: list[str] = []
    """Parameters that the baseline does not vary; they are nominal."""
    realisation: int | None = None
    """The noise seed with which it was evaluated; null for the realisations of the campaign."""


class BaselineResult(StageResult, Described):
    """The findings of the baseline on this model."""

    followed: ClassVar[bool] = True

    stage: Literal["baseline"] = "baseline"
    run: str
    """The baseline, as the campaign names it."""
    cases: list[Reevaluated]
    drawn_realisations: int = 0
    """How many of the first evaluations each simulated a noise seed of the baseline."""

    @property
    def drawn(self) -> int:
        return self.drawn_realisations

    @property
    def seeds(self) -> list[int]:
        """Those of the baseline's findings."""
        drawn = [(c.index, c.realisation) for c in self.cases if c.index is not None and c.realisation is not None]
        return [seed for _, seed in sorted(drawn)]
