"""The API schemas of components, methods and the campaign library."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from backend.http.errors import ProblemError
from backend.http.schema import Schema
from campaigns.catalogue import ParameterEntry
from campaigns.results.drawn import DrawnFlight


class ProblemOut(ProblemError):
    """One error in a campaign: the field, the given value, and what is allowed or to be done."""


class LibraryCampaign(Schema):
    """A shipped campaign; `problems` is empty when this installation can run it."""

    id: str
    digest: str
    document: dict[str, object]
    yaml: str
    problems: list[ProblemOut]
    nominal: DrawnFlight | None
    """Its nominal flight as stored with this installation; null if the campaign's file was changed since."""


class CheckedParameter(Schema):
    """A parameter of the scenario by path: its entry, nominal value, and bounds where it is uncertain."""

    path: str
    entry: ParameterEntry
    nominal: float | None
    low: float | None
    high: float | None


class CriterionOut(Schema):
    """A criterion of a campaign under its name in results: `goal_miss`, a second one `goal_miss#2`."""

    name: str
    component: str
    title: str
    quantity: str
    """d_goal"""
    unit: str
    worse: Literal["low", "high"]
    """The worse direction. Stored costs are always lower when worse; reported values have their own sign."""
    measured_to: Literal["", "centre", "surface"]
    """The reference point of its distances on an obstacle; empty if it has none or it is unknown."""


class EstimatedStage(Schema):
    """The evaluations of all stages of one kind: usually, at least, and at most with those made again."""

    kind: str
    title: str
    evaluations: int
    least: int
    most: int


class Estimate(Schema):
    """What a run of a campaign takes, as ranges; the sentences state where they are known from."""

    evaluations: int
    """Of all stages, validation included: the usual number."""
    least: int
    """The low end of its range; equal to `evaluations` if an earlier run gave the number."""
    most: int
    """The bound of the run, which it never exceeds: evaluations made again to confirm results included."""
    stages: list[EstimatedStage]
    statement: str
    """Where the number of evaluations is known from, a sentence."""
    seconds: float | None
    """Working time of the usual number, about [s]; None if nothing was measured yet."""
    seconds_least: float | None
    """That of the low end, about [s]."""
    seconds_most: float | None
    """That of the high end, about [s]: at the speed that was measured, which bounds no time. None if a stage is not
    part of it (`untimed`)."""
    untimed: list[str] = Field(default_factory=list)
    """The titles of stages whose time is unknown and not part of it: they compute without evaluations."""
    time_statement: str
    """Where the time is known from, or how to measure it, a sentence."""
    run: str | None
    """The finished run of the same campaign whose numbers these are, but for the most; R-0001; None for a usual
    number."""


class PredictedBound(Schema):
    """The bound on P(violation) that a run can show at best: if none of its samples violates, fails or is excluded."""

    source: Literal["certify", "search"]
    """The sample of the bound: that of the certify stage, else of a random search, by which nothing is cleared."""
    samples: int
    outside: float
    """The probability of draws outside the bounds, which is part of the bound."""
    upper_bound: float
    statement: str
    """The bound and its condition, a sentence."""
    warning: str | None
    """That it is above what the campaign requires, and what to do, a sentence; null if it is not."""


class Foreseen(Schema):
    """A check of the verdict that cannot hold, whatever the run finds."""

    code: str
    statement: str
    """Why the campaign cannot be cleared, and what to do, a sentence."""


class Checked(Schema):
    """A checked campaign: its parsed form, or its errors."""

    ok: bool
    problems: list[ProblemOut]
    digest: str | None
    document: dict[str, object] | None
    yaml: str | None
    """Null if it has errors, or more values than a campaign in YAML may have."""
    parameters: list[CheckedParameter]
    evaluations: int | None
    """The bound of the run; `estimate` states what it usually takes."""
    seconds: float | None
    """About what these take at the mean speed of earlier runs with the same components, with the stages that compute
    without evaluations [s]; None if it is not known."""
    estimate: Estimate | None
    """None if the campaign cannot be run."""
    predicted_bound: PredictedBound | None = None
    """Null if the campaign cannot be run, or has no sample that is known to give one."""
    foreseen: list[Foreseen] = Field(default_factory=list)
    """What bars "cleared" whatever the run finds; empty if nothing does, or if the campaign cannot be run."""
