"""The comparison of a run with its baseline: every finding of either, and what follows from the campaign's policy.

What a finding of the baseline costs on this model is measured (`campaigns.results.stage`); whether a finding of this
run is the same is decided by basin, not by label. Margins are to the threshold of this run.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Literal

from campaigns.asked.regression import FailOn
from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Described, Values

PolicyWord = Literal["holds", "fails", "accepts"]
"""What the policy says: no change fails; one fails, whatever the verdict; or the violations of a violated run, all of
them known, are accepted."""


def policy_word(ok: bool | None, accepted: bool | None, verdict: str | None) -> PolicyWord | None:
    """By `ok` and `accepted` of a regression, and the verdict; None without a baseline."""
    if ok is None:
        return None
    if not ok:
        return "fails"
    return "accepts" if accepted and verdict == "violated" else "holds"


class Standing(StrEnum):
    """What has become of a finding."""

    NEW = "new"
    """No finding of the baseline is in its basin; the search of the baseline may have missed it."""
    WORSE = "worse"
    SAME = "same"
    BETTER = "better"
    FIXED = "fixed"
    """It violated in the baseline, and nothing known in its basin violates now."""
    UNRESOLVED = "unresolved"
    """It violated in the baseline and does not now, but the allowance of validation did not suffice to examine its
    basin, or the case was not confirmed by other means."""
    NOT_COMPARED = "not compared"
    """It could not be evaluated on this model as it was there, or has no value."""


class FindingChange(Described):
    """One finding of either run, and its change since the baseline."""

    standing: Standing
    before: str | None
    """Its label in the baseline; null for a new one."""
    now: str | None
    """The finding of this run in the same basin; null if there is none."""
    evaluation: int | None = None
    """Of the baseline stage; null for a new one, and for one that was not evaluated."""
    parameters: Values
    """Of the lowest known case in its basin."""
    margin_before: float | None = None
    """In the baseline, to the threshold of this run."""
    margin_again: float | None = None
    """The same case on this model, as evaluated."""
    margin: float | None = None
    """The lowest known in its basin on this model, or that of the case itself if another one of the baseline stands for
    the basin; null if it has no value."""
    change: float | None = None
    """Of the margin, in the criterion's unit; negative is worse."""
    tolerance: float | None = None
    """A change up to this is no change."""
    newly_violating: bool = False
    """It violates, and in the baseline, by the lower of both thresholds, it did not or was not known."""
    fails: bool = False
    """By the policy of the campaign."""

    @property
    def name(self) -> str:
        """The label of this run, or that of the baseline."""
        return self.now if self.before is None and self.now else f"{self.before} of the baseline"


class Regression(Described):
    """What has changed since the baseline."""

    run: str
    """The baseline."""
    position: int
    """Of the baseline stage."""
    cases: list[FindingChange]
    """Those that fail first, then by margin."""
    fail_on: list[FailOn]
    ok: bool
    """No change fails by the policy. The verdict is another matter."""
    accepted: bool = False
    """The policy leaves out `violation`, findings violate, all of them known, and nothing else is wrong: a
    violated verdict does not fail."""
    quantity: str = ""
    unit: str = ""

    @property
    def failing(self) -> list[FindingChange]:
        """The changes that fail by the policy."""
        return [case for case in self.cases if case.fails]

    def counts(self) -> dict[Standing, int]:
        """How many findings have each standing, those without any omitted."""
        found = {standing: sum(case.standing == standing for case in self.cases) for standing in Standing}
        return {standing: number for standing, number in found.items() if number}


OptionalRegression = Annotated[Regression | None, UNLESS_NONE]
"""Omitted without a baseline."""
