"""The result of a search stage."""

from __future__ import annotations

from typing import Annotated, Literal

from campaigns.documented import UNLESS_EMPTY
from campaigns.results.base import Described, MethodKind, Result, Stop, Values, Worse
from campaigns.results.sample import GridPoint, Sample
from campaigns.results.stage import StageResult


class Best(GridPoint):
    """The lowest evaluation of a stage; `index` counts from 0 within it."""

    index: int | None = None


class Minimum(Described):
    """A local minimum at which a descent ended."""

    start: Values | None
    parameters: Values
    point: list[float] = []
    """On the unit cube."""
    cost: float
    evaluations: int


class Gap(Described):
    """An estimate of the possible improvement below DIRECT's best, from the slopes between its centres."""

    rectangles: int = 0
    without_value: int = 0
    slopes: Values = {}
    """The steepest slope observed, in the criterion's unit per unit of the parameter."""
    lower_bound: float
    gap: float


class FrontCriterion(Result):
    """A criterion of a Pareto front."""

    name: str
    """Numbered if a component occurs twice."""
    title: str
    quantity: str
    unit: str
    worse: Worse


class FrontPoint(Result):
    """An evaluation of the Pareto front; values by the criterion's name, in their own sign."""

    index: int
    parameters: Values
    values: Values


class Apart(Result):
    """A part of a search that does not use the evaluations of the others: what it found, it found by itself."""

    member: str
    """The member that found its best; of several that share what they know, the lowest."""
    title: str
    family: str
    """The principle by which that member searches."""
    evaluations: int
    best: float
    index: int
    """Of its best evaluation, counted from 0 within the stage."""


class Member(Result):
    """The evaluations of one method of a portfolio."""

    member: str
    title: str
    evaluations: int
    best: float | None
    improvements: int
    """How often it improved the best of all methods."""
    apart: Annotated[bool, UNLESS_EMPTY] = False
    """Whether it does not use the evaluations of the others."""
    family: Annotated[str, UNLESS_EMPTY] = ""
    """The principle by which it searches; empty if it is not declared, and in earlier versions."""


class SearchResult(StageResult):
    """What one method found within its budget."""

    stage: Literal["search"] = "search"
    method: str
    title: str
    kind: MethodKind
    family: str = ""
    """The principle that found its best, of a portfolio that of the member; empty in earlier versions."""
    best: Best | None
    evaluations: int
    failed: int
    excluded: int = 0
    seconds: float
    stop: Stop | None
    minima: list[Minimum] = []
    sample: Sample | None = None
    """The statement of a random method's points."""
    gap: Gap | None = None
    members: list[Member] = []
    apart: Annotated[list[Apart], UNLESS_EMPTY] = []
    """Its parts that do not share their evaluations; omitted if it has only one."""
    criteria: list[FrontCriterion] = []
    """The one that decides first."""
    front: list[FrontPoint] | None = None
    """The Pareto front, thinned; null with one criterion."""
    front_size: int | None = None
    """How many evaluations the front has."""

    @property
    def ended(self) -> Stop | None:
        return self.stop
