"""Regression between versions: the worst cases of an earlier run, the baseline, and which changes since it fail.

The policy is part of a campaign's file; the baseline is added at launch.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from campaigns.asked.reading import repeated
from campaigns.asked.scenario import MAX_REALISATION, Realisations, Repeats
from campaigns.asked.values import AS_NUMBER, AS_WHOLE, DISTINCT, Name, Number, Path, Strict
from campaigns.documented import UNLESS_STATED
from campaigns.limits import CHANCE, ROUNDING, ROUNDING_AT_LEAST, TOLERANCE_OF_MARGIN

FailOn = Literal["violation", "new_violation", "new", "worse", "not_compared"]
"""violation: the verdict is violated, or a violation of the baseline is not compared or unresolved; new_violation: a
finding violates that the baseline lacks or that did not violate in it by both thresholds; new: the baseline lacks a
finding; worse: a finding of the baseline is worse; not_compared: a finding of the baseline could not be evaluated, has
no value, or is unresolved."""

DEFAULT: list[FailOn] = ["violation", "new_violation"]


class Policy(Strict):
    """Which changes since the baseline fail a launch with one; without a baseline the verdict alone decides."""

    fail_on: Annotated[list[FailOn], Field(max_length=8), DISTINCT] = DEFAULT
    tolerance: Annotated[float, Field(ge=0), AS_NUMBER] = 0.0
    """A change of the criterion's value up to this, in its unit, is no change."""

    @property
    def usual(self) -> bool:
        """Whether this is what a campaign without a policy has."""
        return self == Policy()


def _once(cases: list[BaselineCase]) -> list[BaselineCase]:
    if twice := repeated(case.label for case in cases):
        raise ValueError(f"{twice} is given twice; a finding has one label")
    return cases


class CallsThere(Strict):
    """The independent calls of a finding of the baseline."""

    made: Annotated[int, Field(ge=1), AS_WHOLE]
    low: Annotated[list[Number], Field(max_length=10_000)] = []
    """The values of those that violated."""

    def differ(self, here: int, threshold: float) -> bool:
        """Whether so many calls here, of which none is at or below the threshold, differ from these beyond chance: by
        Fisher's exact test, one-sided."""
        violating = sum(value <= threshold for value in self.low)
        return CHANCE * math.comb(self.made, violating) <= math.comb(self.made + here, violating)


class BaselineCase(Strict):
    """One finding of the baseline."""

    label: Annotated[str, Field(pattern=r"^F[1-9][0-9]{0,3}$")]
    parameters: Annotated[dict[Path, Number], Field(min_length=1, max_length=64)]
    """By path, in the parameters' units."""
    point: Annotated[list[Annotated[float, Field(ge=0, le=1), AS_NUMBER]], Field(max_length=64)] = []
    """The same on the unit cube of the baseline's campaign."""
    cost: Number
    difference: Annotated[float, Field(ge=0), AS_NUMBER] = 0.0
    """The largest difference between its integrations, or between its evaluations, in the criterion's unit."""
    realisation: Annotated[int, Field(ge=0, lt=MAX_REALISATION), AS_WHOLE] | None = None
    """The noise seed drawn for it; null if it simulated those of its campaign."""
    called: Annotated[Number | None, UNLESS_STATED] = None
    """The value of a violation that only independent calls of it showed; null for any other finding."""
    calls: Annotated[CallsThere | None, UNLESS_STATED] = None
    """Of a simulator that does not repeat; null of any other, and in one of an earlier version."""
    time: Annotated[Number | None, UNLESS_STATED] = None
    """Of its closest approach [s]; null for a criterion without one."""

    @property
    def stated(self) -> float:
        """The value that its run states for it."""
        return self.cost if self.called is None else self.called

    def rounding(self, threshold: float) -> float:
        """The change of its value that is rounding: by its own size and the threshold's, a tenth of its margin at most.

        Never by the nominal cost, which may be a large value that stands for "no encounter"."""
        size, margin = max(abs(self.stated), abs(threshold)), abs(self.stated - threshold)
        return max(min(ROUNDING * size, TOLERANCE_OF_MARGIN * margin), ROUNDING_AT_LEAST * size)


ListedPath = Annotated[str, Field(pattern=r"^(obstacles|environment|faults)\.(0|[1-9][0-9]?)$")]
ComponentThere = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*( on [^\s]{1,60})?$", max_length=124)]
"""A component, and of a fault the input that it acts on."""


class Baseline(Strict):
    """The findings of an earlier run, which this one evaluates first."""

    run: Name
    """R-0001, or a folder of results."""
    digest: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    """Of its campaign."""
    threshold: Number
    horizon: Annotated[Number | None, UNLESS_STATED] = None
    """Of its flights [s]; null for a simulator."""
    realisations: Annotated[Realisations | None, UNLESS_STATED] = None
    """Of noise and gusts in each of its evaluations; null for a simulator."""
    repeats: Annotated[Repeats | None, UNLESS_STATED] = None
    """The calls of a simulator in each of its evaluations; null for a scenario, and in one of an earlier version."""
    fixed: Annotated[dict[Path, Number] | None, UNLESS_STATED] = None
    """By path, the values of the parameters that its campaign did not vary; null in one of an earlier version."""
    parts: Annotated[dict[ListedPath, ComponentThere] | None, UNLESS_STATED] = None
    """The components of its obstacles, environment and faults, by the prefix of their paths; null for a simulator, and
    in one of an earlier version."""
    cases: Annotated[list[BaselineCase], Field(min_length=1, max_length=100), AfterValidator(_once)]

    def violated(self, case: BaselineCase, threshold: float) -> bool:
        """Whether a case violated by its own threshold and by this one."""
        return case.stated <= min(self.threshold, threshold)
