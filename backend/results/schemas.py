"""The API schemas of evaluations, findings and traces."""

from __future__ import annotations

from typing import Literal

from pydantic import computed_field

from backend.catalog.schemas import CriterionOut
from backend.http.schema import Instant, Schema
from campaigns.results import TraceHead
from campaigns.results.base import Status
from campaigns.results.finding import Boundary, ClosestApproach, FoundBy, Validation, granted, violates
from campaigns.results.likelihood import Likelihood
from campaigns.results.slices import Slices
from campaigns.results.trace import TraceColumn


class EvaluationSeries(Schema):
    """One stage's evaluations for charts: improvements, thinned evenly where they are too many, and an even selection
    of the rest.

    Columns of equal length; `index` counts from 0 within the stage.
    """

    position: int
    kind: str
    method: str | None
    started: Instant | None
    """When the stage started; another time than before once the run was reset and begins again."""
    total: int
    """Stored or, of a sample of which only a part is stored, only counted."""
    stored: int
    failed: int
    """Includes timeouts."""
    timeouts: int
    excluded: int
    index: list[int]
    seconds: list[float]
    cost: list[float | None]
    """Cost by the deciding criterion."""
    further: dict[str, list[float | None]]
    """{name: values} of the other criteria, each in its own sign; empty if there are none."""
    status: list[Status]
    parameters: dict[str, list[float]]
    """{path: values} in the parameters' units."""
    seeds: list[int | None]
    """The noise seed of each evaluation that drew its own realisation, else null; empty if none of the stage did."""
    improvements: dict[str, list[float]]
    """`index`, `seconds`, `cost` of every evaluation that was the best so far, and of the last one."""


class EvaluationFailure(Schema):
    """An evaluation without a cost, with the reason."""

    position: int
    index: int
    status: Literal["failed", "timeout", "excluded"]
    reason: str
    parameters: dict[str, float]


class Evaluations(Schema):
    """A run's evaluations, stage by stage."""

    criteria: list[CriterionOut]
    """The criteria, the deciding one first; `cost` and `further` are in their units."""
    stages: list[EvaluationSeries]
    failures: list[EvaluationFailure]
    """At most 200 of them."""


class FindingDetail(Schema):
    """One distinct worst case, with the values of its uncertain parameters and their bounds."""

    label: str
    cost: float
    margin: float
    """Of `granted`, the value to state for it."""
    parameters: dict[str, float]
    nominal: dict[str, float]
    low: dict[str, float]
    high: dict[str, float]
    methods: list[str]
    found: list[FoundBy]
    """Empty if only local refinement found it, not a search."""
    values: dict[str, float | None]
    """{name: value} of every criterion in its own sign, as stored with the trace; empty if it was not stored."""
    at_bounds: dict[str, Literal["low", "high"]]
    validation: Validation | None
    slices: Slices | None
    """Slices through the finding; null if validation ended before, or an earlier version stored none."""
    boundary: Boundary | None
    """The boundary of a violation: its distance from nominal."""
    closest: ClosestApproach | None
    likelihood: Likelihood | None
    """How likely it is under the stated distributions; null if the bounds of a parameter are not known."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def granted(self) -> float:
        """The value to state for it: of a confirmed violation the mildest of its values, if they differ."""
        return granted(self.cost, self.validation)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def violates(self) -> bool:
        """Whether it violates and what evaluates it again confirms that."""
        return violates(self.margin, self.validation)


class TraceInfo(Schema):
    """A stored trace without its data."""

    name: str
    rows: int
    columns: list[TraceColumn]
    meta: TraceHead


class TraceData(TraceInfo):
    """Columns by name, thinned to at most `max_points` rows; the rows nearest the closest approach are kept."""

    data: dict[str, list[float | None]]
