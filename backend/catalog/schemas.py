"""What the API says of components, methods and the library of campaigns."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema
from campaigns.catalogue import Catalogue, ParameterEntry
from campaigns.documents import JsonObject

CatalogueOut = Catalogue


class LibraryCampaign(Schema):
    """A shipped campaign; `problems` is empty when this installation can run it."""

    id: str
    digest: str
    document: JsonObject
    yaml: str
    problems: list[ProblemOut]


class ProblemOut(Schema):
    """One thing wrong with a campaign: the field, what was given, and what is allowed or to do."""

    field: str
    given: str
    message: str


class CheckedParameter(Schema):
    """A parameter of the scenario by path: its entry, nominal value, and bounds where it is uncertain."""

    path: str
    entry: ParameterEntry
    nominal: float | None
    low: float | None
    high: float | None


class CriterionOut(Schema):
    """A criterion of a campaign, by the name that results know it by: `goal_miss`, a second one `goal_miss#2`."""

    name: str
    component: str
    title: str
    quantity: str
    """d_goal"""
    unit: str
    worse: Literal["low", "high"]
    """Which end is sought. Stored costs are all lower when worse; values told have their own sign."""
    measured_to: Literal["", "centre", "surface"]
    """The point of an obstacle that its distances end at; empty where it reads none, or that is not known."""


class Checked(Schema):
    """A campaign as the product understands it, or what is wrong with it."""

    ok: bool
    problems: list[ProblemOut]
    digest: str | None
    document: JsonObject | None
    yaml: str | None
    parameters: list[CheckedParameter]
    evaluations: int | None
    """How many evaluations a run of it would fly."""
    seconds: float | None
    """Estimated from the speed of earlier runs of the same components; None when there are none."""


LibraryCampaign.model_rebuild()
