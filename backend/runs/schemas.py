"""The API schemas of runs: list, detail, what a submission returns."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, computed_field

from backend.catalog.schemas import CriterionOut
from backend.http.schema import Instant, Schema
from backend.runs.sample_kind import BoundSource
from campaigns import Catalogue
from campaigns.claims.spans import Spans
from campaigns.documents import JsonObject
from campaigns.identity.identity import Identity
from campaigns.results import Verdict
from campaigns.results.regression import PolicyWord
from campaigns.results.sample import SoFar
from campaigns.results.verdict import VerdictWord
from campaigns.results.verdicts import DescribedCheck
from campaigns.runs import RunState, StageState
from campaigns.stages.found import AnyResult, StageKind, declared
from campaigns.stages.plan import left
from campaigns.versions import Versions


class HistoryEntry(Schema):
    """An action on a run, from the audit trail."""

    at: Instant
    """Seconds since 1970."""
    user: str
    """The user, or the name of the API token."""
    account: str
    """The user, also of a token."""
    via: str
    """The authentication: link, password, token, or cli for the command line."""
    action: str
    """run.submitted, run.edited, run.cancelled, run.retried, run.restarted, run.continued, run.removed, run.restored,
    run.purged,
    signoff.created, signoff.withdrawn, signoff.bound"""
    detail: dict[str, object]


class Facet(Schema):
    """A value by which runs can be filtered, and its number of runs."""

    value: str
    runs: int


class RunFacets(Schema):
    """The values by which runs can be filtered, most frequent first."""

    campaigns: list[Facet]
    tags: list[Facet]
    owners: list[Facet]
    methods: list[Facet]
    """Methods that found the worst cases."""
    labels: list[Facet]
    """As KEY=VALUE."""


class StageSummary(Schema):
    """A kind of stage of a run."""

    kind: StageKind
    title: str
    description: str
    """A short description of its stages."""


class StageProgress(Schema):
    """The state of a stage; `result` is set once it is done."""

    position: int
    kind: StageKind
    method: str | None
    state: StageState
    planned: int
    evaluations: int
    """Those of a sample of which only the lowest are stored included."""
    stored: int
    failed: int
    excluded: int
    best: float | None
    best_index: int | None
    seconds: float
    started: Instant | None
    finished: Instant | None
    so_far: SoFar | None = None
    """Of a sample of which only the lowest are stored, while it is drawn."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def title(self) -> str:
        """The title of its kind; also for a kind of another version that this installation lacks."""
        stage = declared().get(self.kind)
        return self.kind.capitalize() if stage is None else stage.title

    @computed_field  # type: ignore[prop-decorator]
    @property
    def left(self) -> int:
        """The evaluations that it has left if it uses its whole budget, about: excluded samples are drawn again."""
        done = self.state == StageState.DONE
        return 0 if done else left(self.kind, self.planned, self.evaluations, self.excluded)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def own(self) -> bool:
        """Whether it evaluates the question of the campaign, so that its lowest value counts for the run."""
        stage = declared().get(self.kind)
        return stage is not None and stage.against


class StageDetail(StageProgress):
    """A stage with its result."""

    result: AnyResult | None


class RunDoing(Schema):
    """What the worker of a running run does besides its stages."""

    sentence: str
    """Compiling your closed loop, about 15 s, once: it is stored for later runs."""
    since: Instant
    """Seconds since 1970."""
    seconds: float | None
    """Estimated from earlier ones on the same machine [s]; None if there are none."""


class RunBaseline(Schema):
    """The baseline with which a run was launched."""

    asked: str
    """As given: R-0001, or label:branch=main."""
    run: str | None
    """R-0001; null if no run has the label, and nothing is compared."""
    sentence: str


class RunSummary(Schema):
    """A run as in the list. Times are seconds since 1970; costs and margins are in `unit`."""

    id: str
    """R-0001"""
    name: str
    tags: list[str]
    labels: dict[str, str]
    """Given at launch, in alphabetical order."""
    owner: str
    """The user who submitted it, also by a token."""
    token: str | None
    """The name of the API token that submitted it; null without one."""
    state: RunState
    verdict: VerdictWord | None
    not_sampled: bool
    """Whether nothing but an independent sample is missing to clear it."""
    earlier_rules: bool
    """Whether it is cleared by the rules of an earlier version, and `clearance audit` names what does not hold by those
    of today."""
    against: str = ""
    """Of a run that is cleared or inconclusive: the listed runs that violate its criterion, found a value at or below
    its threshold, with or without a verdict, or saw beyond the horizon what bars a cleared verdict, on the same
    question and model, a sentence; empty without any."""
    reason: str | None
    """The verdict's sentence."""
    error: str | None
    campaign_name: str
    campaign_digest: str
    quantity: str
    """d_min"""
    unit: str
    """m"""
    threshold: float | None
    nominal_cost: float | None
    worst_cost: float | None
    margin: float | None
    worst_method: str | None
    evaluations: int
    planned: int
    failed_evaluations: int
    """Includes timeouts."""
    excluded_evaluations: int
    code: str | None
    """Digest of the run's identity: engine, own files, packages; None before its first stage, or if something of it is
    not identified."""
    unidentified: list[str]
    """What of its identity was not stored or cannot be read exactly."""
    created: Instant
    started: Instant | None
    finished: Instant | None
    stage: StageProgress | None
    """The running stage."""
    waits: str | None
    """Why a queued run has not started; None for any other."""
    other_code: str | None
    """What differs between the code that began it and that of every running worker, as clauses; None if it does not
    wait for that."""
    doing: RunDoing | None
    """What its worker does besides the stages, such as compiling; None if nothing."""
    attempts: int
    worker: str | None
    continues: str | None
    """The run whose searches this one extends, or whose evaluations it begins with, R-0001."""
    pinned: bool
    best_so_far: list[tuple[int, float]]
    """Convergence history of the searches: the number of evaluations of the run up to then, and the lowest cost that a
    search had evaluated, thinned for a sparkline. What other stages evaluate enters `worst_cost` only."""
    upper_bound: float | None
    """Upper bound on P(violation), from the sample that `bound_source` names; None without one."""
    bound_source: BoundSource | None
    """`certify`: the independent sample of the certify stage. `certify_stated`: the same with a stated seed, which
    a user may have chosen. `search`: there is no certify stage, and the sample is a random search with the seed of
    the campaign. Nothing is cleared by the last two. Null without a bound."""
    excluded_samples: int | None = None
    """Draws of that sample that were excluded, of which the bound says nothing, or which it counts as no violations;
    null without a bound, and in results of earlier versions."""
    excluded_fraction: float | None = None
    """Of all draws of that sample."""
    policy: PolicyWord | None = None
    """What the campaign's policy says of the changes since the baseline: `holds`; `fails`, which is exit code 1
    whatever the verdict; `accepts`, a violated run whose violations were all known. Null without a comparison."""
    removed: Instant | None
    """Time of removal from all lists; None if it is listed."""
    removed_by: str | None
    removed_reason: str | None
    group: str | None
    """Its concurrency group: a newer run of the same group cancels it, if it has the same owner or an administrator
    launches it."""
    superseded_by: str | None
    """The run of its group that cancelled it, R-0001."""


class RunSubmitted(RunSummary):
    """The run that answers a submission."""

    reused: str | None = None
    """Why it is an earlier run; null if it was queued."""
    baseline: RunBaseline | None = None
    """The baseline that was asked for; null without one."""
    superseded: list[str] = Field(default_factory=list)
    """The runs of the same group that this one cancelled, R-0001."""


class RunVerdict(Verdict):
    """The verdict of a run, with its checks."""

    checks: list[DescribedCheck]  # type: ignore[assignment]


class RunDetail(RunSummary):
    """A run with its campaign, stages and provenance."""

    not_continuable: str | None
    """Why a run that waits for the code that began it cannot be continued as a new run; None if it can be, and for any
    other run."""

    notes: str
    """In Markdown."""
    baseline: RunBaseline | None
    """What it is compared with; null if it was launched without a baseline."""
    campaign: JsonObject
    criteria: list[CriterionOut]
    """The deciding criterion, then the objectives."""
    components_digest: str | None
    """Digest of the component descriptions at submission (`/runs/{run}/components`); None if not stored."""
    flown: Versions | None
    """The versions when the first stage started: code, packages, machine; None before that, or if not stored."""
    undigested: str | None
    """That the run was begun by a version that stored no digests of its code, a clause; None for any other run."""
    identity: Identity | None
    """What could have changed a number: engine, own files, packages, machine; None as of `flown`."""
    plan: list[StageSummary]
    """The kinds of stages in the order of the run."""
    stages: list[StageProgress]
    """Empty until a worker has started the run."""
    summary: RunVerdict | None
    """The verdict with its evidence; null until there is one."""
    unconfirmed: Spans = ()
    """Of a cancelled or failed run: the sentence on its lowest value, where that is at or below the threshold and thus
    speaks against a requirement without a verdict; empty otherwise."""
    against_runs: list[str] = Field(default_factory=list)
    """All runs of which `against` names the first."""
    rules: str
    """That earlier rules cleared it, sentences; empty for any other run."""
    untraced: str
    """Of a simulator: why no trace is stored, sentences; empty if one is, and for any other run."""
    rate: float | None
    """Evaluations per second of the running stage."""
    remaining: float | None
    """Estimated time left [s]; None while it cannot be estimated."""
    untimed: list[str] = Field(default_factory=list)
    """The titles of stages that have not ended whose time is not part of it: they compute without evaluations."""


class RunComponents(Schema):
    """The descriptions of a run's components and methods: texts, units, limits and default values."""

    digest: str | None
    """SHA-256 of the stored snapshot; None if nothing was stored, in which case the installed ones are reported."""
    catalogue: Catalogue
    """The entries that the run's campaign uses."""
    changes: list[str]
    """Differences of the descriptions that a worker published last, as sentences; empty if there are none."""
    code: str | None
    """Digest of the identity of the run; None if it has not started, or if something of it is not identified."""
    code_installed: str | None
    """Of what the newest worker has installed, with the compiled loop of the run, which workers do not publish; None if
    no live worker reports it, or if something is not identified."""
    code_changes: list[str]
    """What differs between the two: own files, packages, modules of the engine."""
    unidentified: list[str]
    """What of the two was not stored or cannot be read exactly, and may have changed."""


class ChangedFile(Schema):
    """A source file that is not the same in the code of two runs."""

    file: str
    """worker/engine/components/avoiders/ge_cui.py, or an own one: components/my_robot.py, simulators/pendulum"""
    change: Literal["changed", "added", "removed"]
    component: str | None
    """The component or search method of the campaign that it is; None for all others."""


class CodeChanges(Schema):
    """The difference between the code that ran a run and that of another one, of what both use."""

    code: str | None
    """Digest of the run's identity; None if something of it is not identified."""
    against: str | None
    """That of the other run."""
    changes: list[str]
    """What differs, as clauses: engine, own files, packages."""
    unidentified: list[str]
    """What of the two was not stored or cannot be read exactly, and may differ."""
    same_model: bool
    """Whether both may have evaluated the same model: false only if a file of it is known to differ."""
    same_question: bool | None
    """Whether both ask the same, so that a violation of one speaks against the other; None if that is not stored."""
    files: list[ChangedFile] | None
    """The source files that differ, own files and those of the campaign's components and methods first; None unless
    the files of both engines are stored."""


class RunPage(Schema):
    """A page of the run list."""

    items: list[RunSummary]
    next_cursor: str | None
    counts: dict[str, int]
    """The numbers of runs by state and by verdict for the same filters but state and verdict, and of removed runs."""
