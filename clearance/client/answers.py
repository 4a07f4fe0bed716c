"""What the service answers, as types. Times are `datetime` in UTC; costs and margins are in the run's unit.

A field that this version does not describe is ignored, and is still in `document`, the JSON as it was sent; what
earlier versions did not send has a default. So a client works with services of other versions. A test compares every
field with the OpenAPI document.
"""

from __future__ import annotations

from typing import Any, Self

from pydantic import AwareDatetime, ConfigDict, ModelWrapValidatorHandler, PrivateAttr, model_validator

from campaigns.documented import Documented
from campaigns.documents import JsonObject
from campaigns.runs import ACTIVE


class Answer(Documented):
    """A part of an answer; `document` is its JSON as it was sent."""

    model_config = ConfigDict(frozen=True, extra="ignore")
    _document: JsonObject = PrivateAttr(default_factory=dict)

    @model_validator(mode="wrap")
    @classmethod
    def _kept(cls, given: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        made = handler(given)
        if isinstance(given, dict):
            made._document = given
        return made

    @property
    def document(self) -> JsonObject:
        """The JSON as the service sent it."""
        return self._document


class StageProgress(Answer):
    """A stage of a run; started and finished are None until it does."""

    position: int
    kind: str
    method: str | None
    state: str
    planned: int
    evaluations: int
    failed: int
    best: float | None
    seconds: float
    started: AwareDatetime | None
    finished: AwareDatetime | None


class Baseline(Answer):
    """The run with which one is compared; `run` is None if there is none with the label."""

    asked: str
    run: str | None
    sentence: str


class Check(Answer):
    """One condition of "cleared": `standing` is "holds", "open" or "fails"."""

    name: str
    title: str
    standing: str
    text: str


class VerdictParts(Answer):
    """The verdict with its evidence; all of it is in `document`."""

    verdict: str
    sentence: str
    scope: str
    checks: list[Check]


class Run(Answer):
    """A run: its state, and its verdict once it is done."""

    id: str
    """R-0001"""
    name: str
    owner: str
    tags: list[str]
    labels: dict[str, str] = {}
    state: str
    """queued, running, cancelling, cancelled, failed, done"""
    verdict: str | None
    """cleared, violated, inconclusive; None until it is done"""
    reason: str | None
    """The sentence of the verdict."""
    error: str | None
    """Why it failed."""
    campaign_name: str
    campaign_digest: str
    quantity: str
    unit: str
    threshold: float | None
    nominal_cost: float | None
    worst_cost: float | None
    margin: float | None
    """Of the worst case to the threshold."""
    upper_bound: float | None = None
    """Of P(violation), from the independent sample."""
    evaluations: int
    planned: int
    failed_evaluations: int
    created: AwareDatetime
    started: AwareDatetime | None
    finished: AwareDatetime | None
    stage: StageProgress | None
    waits: str | None = None
    """Why a queued run has not started."""
    other_code: str | None = None
    """What differs from the code that began it, where it waits for that."""
    continues: str | None = None
    """The run that it continues, R-0001."""
    pinned: bool = False
    group: str | None = None
    """Its concurrency group; a newer run of the same group and owner cancels it."""
    superseded_by: str | None = None
    """The run of the group that cancelled it."""

    @property
    def ended(self) -> bool:
        """Whether it no longer changes."""
        return self.state not in ACTIVE

    @property
    def seconds(self) -> float | None:
        """The time from start to end [s]; None before the end."""
        if self.started is None or self.finished is None:
            return None
        return (self.finished - self.started).total_seconds()


class Submitted(Run):
    """The answer to a submission: the run that was queued, or the one that is reused."""

    reused: str | None = None
    """Why it is an earlier run; None if it was queued."""
    baseline: Baseline | None = None
    superseded: list[str] = []
    """The runs of the same group that this one cancelled."""


class RunDetail(Run):
    """A run with its campaign, its stages and the parts of its verdict."""

    notes: str
    campaign: JsonObject
    baseline: Baseline | None = None
    stages: list[StageProgress]
    summary: VerdictParts | None
    """None until there is a verdict."""
    remaining: float | None = None
    """Estimated time left [s]."""


class RunPage(Answer):
    """A page of the list of runs."""

    items: list[Run]
    next_cursor: str | None
    counts: dict[str, int]


class Validation(Answer):
    """The repeated evaluation of a finding."""

    ok: bool


class Finding(Answer):
    """One distinct worst case: F1 is the worst. Parameters by path, in their units."""

    label: str
    cost: float
    margin: float
    parameters: dict[str, float]
    nominal: dict[str, float]
    low: dict[str, float]
    high: dict[str, float]
    methods: list[str]
    values: dict[str, float | None]
    """The value of every criterion."""
    at_bounds: dict[str, str]
    validation: Validation | None


class TraceColumn(Answer):
    """A quantity over time."""

    name: str
    unit: str


class TraceInfo(Answer):
    """A stored trace: nominal, F1, F2, ..."""

    name: str
    rows: int
    columns: list[TraceColumn]


class TraceData(TraceInfo):
    """A trace as the service sends it; `Client.trace` returns arrays."""

    data: dict[str, list[float | None]]


class Outcome(Answer):
    """The outcome of one run of a sweep."""

    state: str
    verdict: str | None
    margin: float | None
    upper_bound: float | None
    """Of P(violation), with this confidence."""
    confidence: float | None
    unit: str
    error: str | None


class SweepPoint(Answer):
    """A value and its run; outcome is None if its results were purged."""

    value: float
    run: str
    outcome: Outcome | None


class Sweep(Answer):
    """Runs over the values of one fixed parameter, in ascending order."""

    id: str
    """S-0001"""
    name: str
    path: str
    unit: str
    owner: str
    created: AwareDatetime
    runs: int
    states: dict[str, int]
    points: list[SweepPoint]

    @property
    def ended(self) -> bool:
        """Whether every run of it has ended."""
        return not set(self.states) & set(ACTIVE)


class ExportFile(Answer):
    """A file of a run; `unavailable` is the reason why it is not available now."""

    name: str
    title: str
    media_type: str
    href: str
    unavailable: str | None


class FieldProblem(Answer):
    """An invalid field of a campaign."""

    field: str
    given: str
    message: str


class Checked(Answer):
    """What the service found in a campaign; it can be run if `ok`."""

    ok: bool
    digest: str | None
    problems: list[FieldProblem]


class Health(Answer):
    """That the service responds."""

    status: str
