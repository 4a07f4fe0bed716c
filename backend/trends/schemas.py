"""The API schemas of runs of the same campaign."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema
from backend.runs.outcomes import Outcome
from backend.runs.schemas import Facet

Difference = Literal["seed", "code"]


class RelatedRun(Outcome):
    """Another run of the same campaign."""

    differs: list[Difference]
    """What is known to differ: nothing (empty), the seed, or the code."""
    code_changes: list[str]
    """What differs in the code: own files, packages, modules of the engine."""
    code_known: bool
    """Whether the code of both runs is identified; if not, it may differ as well."""


class RelatedRuns(Schema):
    """Other runs with the same campaign, and those that differ in one thing: the seed or the code."""

    runs: list[RelatedRun]
    """The newest of them, newest first."""
    total: int
    """How many there are."""
    question: dict[str, int]
    """All runs of the service that ask the same question (system, bounds and criterion, at any threshold), this one and
    removed ones included, by verdict; `unconfirmed` has none, but found a value at or below the threshold of this run;
    `none` has none."""
    against: str
    """As of the run: which others speak against its verdict, a sentence; empty if none does."""


class TrendRun(Outcome):
    """A run in a trend."""

    code_changed: bool
    """Whether its code differs from that of the newest earlier run in the trend whose code is stored, in what both
    use."""
    code_changes: list[str]
    """What differs in it: own files, packages, modules of the engine."""
    campaign_changed: bool
    """Whether its campaign differs from that of the run before it; a baseline that was added at launch is no
    difference."""
    requirements: list[str]
    """The ids of the requirements that its campaign states."""
    labels: dict[str, str]
    """Such as branch: main; given at launch."""


class Trend(Schema):
    """The runs of a campaign in the order of their numbers, which is that of submission."""

    name: str
    """The campaign's name."""
    digest: str | None
    """The campaign's digest; null for all campaigns of that name."""
    campaigns: int
    """How many different campaigns are among the runs; baselines are no difference."""
    labels: list[Facet]
    """The labels of all runs, also of those without the labels that were asked for: by which they can be narrowed."""
    runs: list[TrendRun]
    """The newest of them, oldest first."""
    total: int
    """How many there are."""
    sweeps: int
    """Runs of sweeps that are left out: variants, of other values than the campaigns of this name."""
