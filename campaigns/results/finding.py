"""A finding: one distinct worst case with all its own evidence."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from campaigns.documented import UNLESS_NONE, UNSTATED
from campaigns.results.base import Described, Result, Values
from campaigns.results.slices import Slices
from campaigns.results.trace import Closest


class HalfStep(Result):
    """The case at half the step."""

    step: float
    """[s]"""
    cost: float | None
    difference: float | None
    reason: Annotated[str, UNSTATED] = ""
    """Of a simulator: why it has no cost, such as an FMU that refuses this step; omitted if it has one."""


class ReferenceCost(Result):
    """The case with the reference integrator."""

    name: str
    cost: float | None
    difference: float | None
    reason: str = ""
    """Why it has no cost; or, where the loop chatters, from when and why its tolerance was larger."""


class Repeated(ReferenceCost):
    """The same case in a fresh evaluation."""

    name: str
    """How it was evaluated again."""


class Calls(Described):
    """Independent calls of a simulator that does not repeat; none of them chose the case. Each is in a fresh process;
    those of a function with `isolated=False` are in the same one."""

    values: list[float | None]
    """Of each call; null for one that failed."""
    reasons: list[str] = []
    """The distinct reasons of those that failed."""
    violating: int
    failed: int
    confidence: float
    low: float
    """The Clopper-Pearson interval of the probability that a call violates; a failed call counts as unknown: as clear
    below, as a violation above."""
    high: float


class Neighbours(Result):
    """Evaluations around a finding."""

    flown: int
    failed: int
    lowest: float | None
    lower_by: float | None
    """How far the lowest neighbour was below the finding before it replaced it."""


class Validation(Result):
    """A case simulated again by other means."""

    name: str
    step: float | None
    """[s]; null for a system without a step."""
    cost: float | None
    half_step: HalfStep | None = None
    """Null for a system without a step."""
    integrator: ReferenceCost | None = None
    """Null for a system that has no reference integrator."""
    again: Annotated[Repeated | None, UNLESS_NONE] = None
    """The same evaluation repeated; omitted if it is compared with other means instead."""
    repeats: Annotated[Calls | None, UNLESS_NONE] = None
    """Of a simulator that does not repeat, in place of the other comparisons; omitted for any other system."""
    allowed: float | None
    """The tolerance, in the criterion's unit; null where values are not compared."""
    ok: bool
    """Validated: it agrees or it violates."""
    agrees: bool | None = None
    """Both differences are within tolerance, and all values on the same side of the threshold."""
    violates: bool | None = None
    """Every integration violates, however much they differ."""
    realisation: int | None = None
    """The noise seed drawn for its evaluation; null if it simulated those of the campaign."""
    neighbours: Neighbours | None = None

    @property
    def incomplete(self) -> bool:
        """Whether one of the values that are compared is missing."""
        return self.cost is None or any(other.cost is None for other in self._others)

    @property
    def values(self) -> Iterator[float]:
        """All values that the criterion was seen to have in this case, by whatever means."""
        calls = [] if self.repeats is None else self.repeats.values
        yield from (v for v in (self.cost, *(other.cost for other in self._others), *calls) if v is not None)

    @property
    def _others(self) -> list[HalfStep | ReferenceCost]:
        return [other for other in (self.half_step, self.integrator, self.again) if other is not None]


def granted(cost: float, case: Validation | None) -> float:
    """What every value of a confirmed violation grants: the mildest of them if they differ beyond tolerance; of any
    other case its own value. Independent calls, of which some violate, grant the mildest of these."""
    if case is None or case.agrees or not case.violates:
        return cost
    if case.repeats is not None:
        return sorted(v for v in case.repeats.values if v is not None)[case.repeats.violating - 1]
    return max(cost, *case.values)


def violates(margin: float, case: Validation | None) -> bool:
    """Whether a case violates and every integration of it confirms that; of a simulator that does not repeat, whether
    an independent call of it violates."""
    return case is not None and bool(case.violates) and (margin <= 0 or case.repeats is not None)


class Ray(Result):
    """The nearest violation seen along one line from nominal, the nearest failure where nothing violates; null fields
    where neither was seen. A nearer one may be between two evaluations."""

    path: str
    """The parameter that varies; empty on the line to the worst case."""
    towards: str
    kind: Literal["failure", "violation"] | None = None
    way: float | None = None
    """The fraction of the line."""
    share: float | None = None
    """The largest fraction of a range that is crossed."""
    cost: float | None = None
    value: float | None = None
    distance: float | None = None
    parameters: Values | None = None


class Boundary(Described):
    """How far from nominal the nearest violation seen is, along each parameter and towards the worst case.

    A nearer one between two evaluations is not excluded.
    """

    tolerance: float
    """Fraction of each range to which a violation is located by bisection."""
    looks: int
    """Steps on each line, besides the stored evaluations on it."""
    rays: list[Ray]
    line: Ray | None


class ClosestApproach(Result):
    """When the closest approach took place, and whether that is the first or the last instant simulated."""

    time: float | None = None
    """[s]"""
    at: Literal["start", "inside", "end", "none"] = "none"
    obstacle: int | None = None

    @staticmethod
    def of(closest: Closest | None, rows: int) -> ClosestApproach:
        """The summary of a trace with `rows` rows, from its closest approach."""
        if closest is None:
            return ClosestApproach()
        at: Literal["start", "end", "inside"] = "inside"
        if closest.row == 0 or closest.row >= rows - 1:
            at = "start" if closest.row == 0 else "end"
        return ClosestApproach(time=closest.time, at=at, obstacle=closest.obstacle)


class FoundBy(Result):
    """A search stage that found this case by itself."""

    position: int
    method: str
    evaluations: int
    """How many of its evaluations it needed until then."""


class Finding(Result):
    """One distinct worst case; parameters at full precision."""

    label: str
    """F1 is the worst."""
    cost: float
    margin: float
    parameters: Values
    point: list[float]
    """On the unit cube."""
    methods: list[str]
    """Search methods that found it by themselves; empty if only polishing did."""
    found: list[FoundBy] = []
    at_bounds: dict[str, Literal["low", "high"]] = {}
    validation: Validation | None
    slices: Slices | None = None
    """Through the finding; null if validation ended before, or in results of earlier versions."""
    boundary: Boundary | None = None
    """Of a violation."""
    closest: ClosestApproach | None = None

    @property
    def violates(self) -> bool:
        """Whether it is a confirmed violation."""
        return violates(self.margin, self.validation)

    @property
    def granted(self) -> float:
        """The value to state for it: of a confirmed violation what every integration grants."""
        return granted(self.cost, self.validation)

    @property
    def realisation(self) -> int | None:
        """The noise seed drawn for its evaluation."""
        return None if self.validation is None else self.validation.realisation
