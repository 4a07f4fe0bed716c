"""The API schemas of sweeps."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field, field_validator

from backend.http.schema import Given, Instant, Schema
from backend.runs.outcomes import Outcome
from backend.runs.requests import Tags
from campaigns.asked.values import Number, Path
from campaigns.labels import Labels

MOST = 50
"""Values of one sweep."""
PURGED = "purged"
"""In place of a state: of a run of which the results were purged."""


class SweepSubmit(Given):
    """A campaign, and the values of one of its fixed parameters; each value is a run."""

    checked_elsewhere: ClassVar = frozenset({"campaign"})
    campaign: dict[str, object]
    path: Annotated[Path, Field(description="A parameter that is not uncertain, such as avoider.d_0.")]
    values: Annotated[list[Number], Field(min_length=2, max_length=MOST, description="In the parameter's unit.")]
    name: Annotated[str, Field(min_length=1, max_length=120)] | None = None
    tags: Tags | None = None
    labels: Labels = Field(default_factory=dict)
    """Of every run."""
    priority: Annotated[int, Field(ge=-10, le=10)] = 0

    @field_validator("values")
    @classmethod
    def _distinct(cls, values: list[float]) -> list[float]:
        twice = next((value for i, value in enumerate(values) if value in values[:i]), None)
        if twice is not None:
            raise ValueError(f"{twice:.15g} is given twice; list each value once")
        return values


class SweepSummary(Schema):
    """A sweep as in the list. Times are seconds since 1970."""

    id: str
    """S-0001"""
    name: str
    campaign_name: str
    path: str
    """The parameter that differs between its runs."""
    title: str
    """The description of the parameter."""
    unit: str
    owner: str
    """The user who launched it, also by a token."""
    token: str | None
    """The name of the API token that launched it."""
    created: Instant
    runs: int
    states: dict[str, int]
    """The numbers of its runs by state and by verdict; those of which the results were purged as `purged`; of
    the cleared ones those as `contradicted` that other runs speak against."""
    code_warning: str = ""
    """That its runs that are done were run by different code, or that it may differ because it is not identified,
    sentences; empty if all of them have the same."""


class SweepPoint(Schema):
    """One value and its run."""

    value: float
    run: str
    """R-0001"""
    outcome: Outcome | None
    """Null if the results were purged."""


class SweepDetail(SweepSummary):
    """A sweep with its runs, in ascending order of the values."""

    nominal: float | None
    """The parameter's value in the campaign."""
    points: list[SweepPoint]
