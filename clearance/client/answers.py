"""What the service answers, as types. Times are `datetime` in UTC; costs and margins are in the run's unit.

Written by `python -m tools.generated` from the OpenAPI document. A field that is not described here is ignored, and is
still in `document`, the JSON as it was sent; what earlier versions did not send has a default. So a client works with
services of other versions. Start reading at `Run`.
"""

from __future__ import annotations

from pydantic import AwareDatetime

from campaigns.documents import JsonObject
from clearance.client.answer import Answer, RunAnswer, SweepAnswer


class Health(Answer):
    """Minimal, because no authentication is required."""

    status: str


class FieldProblem(Answer):
    """One error in a campaign: the field, the given value, and what is allowed or to be done."""

    field: str
    given: str
    message: str


class PredictedBound(Answer):
    """The bound on P(violation) that a run can show at best: if none of its samples violates, fails or is excluded."""

    source: str | None = None
    """The sample of the bound: that of the certify stage, else of a random search, by which nothing is cleared."""
    samples: int | None = None
    outside: float | None = None
    """The probability of draws outside the bounds, which is part of the bound."""
    upper_bound: float | None = None
    statement: str
    """The bound and its condition, a sentence."""
    warning: str | None
    """That it is above what the campaign requires, and what to do, a sentence; None if it is not."""


class Foreseen(Answer):
    """A check of the verdict that cannot hold, whatever the run finds."""

    code: str
    statement: str
    """Why the campaign cannot be cleared, and what to do, a sentence."""


class Checked(Answer):
    """A checked campaign: its parsed form, or its errors."""

    ok: bool
    problems: list[FieldProblem]
    digest: str | None
    yaml: str | None = None
    """None if it has errors, or more values than a campaign in YAML may have."""
    evaluations: int | None = None
    """The bound of the run; `estimate` states what it usually takes."""
    seconds: float | None = None
    """About what these take at the mean speed of earlier runs with the same components, with the stages that compute
    without evaluations [s]; None if it is not known.
    """
    predicted_bound: PredictedBound | None = None
    """None if the campaign cannot be run, or has no sample that is known to give one."""
    foreseen: list[Foreseen] = []
    """What bars "cleared" whatever the run finds; empty if nothing does, or if the campaign cannot be run."""


class ExportFile(Answer):
    """An export file: its name, its content and its address."""

    name: str
    """R-0001-unicycle-past-a-pillar-evaluations.csv"""
    file: str | None = None
    """Its name without that of the run: evaluations.csv"""
    title: str
    text: str | None = None
    media_type: str
    href: str
    unavailable: str | None
    """The reason why it is not available now; None if it is."""


class StageProgress(Answer):
    """The state of a stage; `result` is set once it is done."""

    position: int
    kind: str
    method: str | None
    state: str
    """waiting, running, done"""
    planned: int
    evaluations: int
    """Those of a sample of which only the lowest are stored included."""
    stored: int | None = None
    failed: int
    excluded: int | None = None
    best: float | None
    best_index: int | None = None
    seconds: float
    started: AwareDatetime | None = None
    finished: AwareDatetime | None = None
    title: str | None = None
    """The title of its kind; also for a kind of another version that this installation lacks."""
    left: int | None = None
    """The evaluations that it has left if it uses its whole budget, about: excluded samples are drawn again."""
    own: bool | None = None
    """Whether it evaluates the question of the campaign, so that its lowest value counts for the run."""


class Baseline(Answer):
    """The baseline with which a run was launched."""

    asked: str
    """As given: R-0001, or label:branch=main."""
    run: str | None
    """R-0001; None if no run has the label, and nothing is compared."""
    sentence: str


class Check(Answer):
    """A check as displayed: its title, whether it holds, and its limitation."""

    code: str | None = None
    """What it is about; any string for a check of another package."""
    ok: bool | None = None
    title: str
    standing: str
    """`open`: it holds for the evaluations that have a value, but others failed."""
    text: str
    """The sentence as plain text."""
    values: dict[str, float] = {}
    """The numbers from which it follows."""
    name: str
    """The code."""
    but: str | None = None
    """Its limitation, as plain text."""


class Sureness(Answer):
    """An estimate from searches on random landscapes, never a bound; it enters no verdict.

    It says nothing of a case that this kind of search cannot find.
    """

    chance: float
    """Of another search, with another seed and the same budget, to find a case lower by more than `lower`."""
    lower: float
    """A hundredth of nominal minus worst, in the criterion's unit."""
    landscapes: int
    """Random landscapes on which it was set; the statement has how many parameters they have."""
    text: str
    """The sentence as plain text."""


class VerdictParts(Answer):
    """The verdict of a run, with its checks."""

    verdict: str
    """cleared, violated, inconclusive"""
    checks: list[Check]
    quantity: str | None = None
    unit: str | None = None
    sureness: Sureness | None = None
    """How likely another search finds a lower case; omitted in results of earlier versions, and where it is not known:
    only of a whole search by `auto` alone.
    """
    sentence: str
    """What may be claimed, as plain text."""
    scope: str
    """The scope of the sentence, as plain text."""
    values: dict[str, float] = {}
    """The numbers of the sentence by name."""
    not_sampled: bool | None = None
    """Whether nothing but an independent sample is missing: every other check holds, as in what earlier versions
    cleared without one.
    """


class Run(RunAnswer):
    """A run as in the list. Costs and margins are in `unit`."""

    id: str
    """R-0001"""
    name: str
    tags: list[str]
    labels: dict[str, str] = {}
    """Given at launch, in alphabetical order."""
    owner: str
    """The user who submitted it, also by a token."""
    token: str | None = None
    """The name of the API token that submitted it; None without one."""
    state: str
    """queued, running, cancelling, cancelled, failed, done"""
    verdict: str | None
    """cleared, violated, inconclusive"""
    not_sampled: bool | None = None
    """Whether nothing but an independent sample is missing to clear it."""
    earlier_rules: bool | None = None
    """Whether it is cleared by the rules of an earlier version, and `clearance audit` names what does not hold by those
    of today.
    """
    against: str | None = None
    """Of a run that is cleared or inconclusive: the listed runs that violate its criterion, found a value at or below
    its threshold, with or without a verdict, or saw beyond the horizon what bars a cleared verdict, on the same
    question and model, a sentence; empty without any.
    """
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
    worst_method: str | None = None
    evaluations: int
    planned: int
    failed_evaluations: int
    """Includes timeouts."""
    excluded_evaluations: int | None = None
    code: str | None = None
    """Digest of the run's identity: engine, own files, packages; None before its first stage, or if something of it is
    not identified.
    """
    unidentified: list[str] = []
    """What of its identity was not stored or cannot be read exactly."""
    created: AwareDatetime
    started: AwareDatetime | None
    finished: AwareDatetime | None
    stage: StageProgress | None
    """The running stage."""
    waits: str | None = None
    """Why a queued run has not started; None for any other."""
    other_code: str | None = None
    """What differs between the code that began it and that of every running worker, as clauses; None if it does not
    wait for that.
    """
    attempts: int | None = None
    worker: str | None = None
    continues: str | None = None
    """The run whose searches this one extends, or whose evaluations it begins with, R-0001."""
    pinned: bool | None = None
    best_so_far: list[tuple[int, float]] = []
    """Convergence history of the searches: the number of evaluations of the run up to then, and the lowest cost that a
    search had evaluated, thinned for a sparkline. What other stages evaluate enters `worst_cost` only.
    """
    upper_bound: float | None = None
    """Upper bound on P(violation), from the sample that `bound_source` names; None without one."""
    bound_source: str | None = None
    """`certify`: the independent sample of the certify stage. `certify_stated`: the same with a stated seed, which a
    user may have chosen. `search`: there is no certify stage, and the sample is a random search with the seed of the
    campaign. Nothing is cleared by the last two. None without a bound.
    """
    excluded_samples: int | None = None
    """Draws of that sample that were excluded, of which the bound says nothing, or which it counts as no violations;
    None without a bound, and in results of earlier versions.
    """
    excluded_fraction: float | None = None
    """Of all draws of that sample."""
    policy: str | None = None
    """What the campaign's policy says of the changes since the baseline: `holds`; `fails`, which is exit code 1
    whatever the verdict; `accepts`, a violated run whose violations were all known. None without a comparison.
    """
    removed: AwareDatetime | None = None
    """Time of removal from all lists; None if it is listed."""
    removed_by: str | None = None
    removed_reason: str | None = None
    group: str | None = None
    """Its concurrency group: a newer run of the same group cancels it, if it has the same owner or an administrator
    launches it.
    """
    superseded_by: str | None = None
    """The run of its group that cancelled it, R-0001."""


class Submitted(Run):
    """The run that answers a submission."""

    reused: str | None = None
    """Why it is an earlier run; None if it was queued."""
    baseline: Baseline | None = None
    """The baseline that was asked for; None without one."""
    superseded: list[str] = []
    """The runs of the same group that this one cancelled, R-0001."""


class RunDetail(Run):
    """A run with its campaign, stages and provenance."""

    not_continuable: str | None = None
    """Why a run that waits for the code that began it cannot be continued as a new run; None if it can be, and for any
    other run.
    """
    notes: str
    """In Markdown."""
    baseline: Baseline | None = None
    """What it is compared with; None if it was launched without a baseline."""
    campaign: JsonObject
    components_digest: str | None = None
    """Digest of the component descriptions at submission (`/runs/{run}/components`); None if not stored."""
    undigested: str | None = None
    """That the run was begun by a version that stored no digests of its code, a clause; None for any other run."""
    stages: list[StageProgress]
    """Empty until a worker has started the run."""
    summary: VerdictParts | None
    """The verdict with its evidence; None until there is one."""
    against_runs: list[str] = []
    """All runs of which `against` names the first."""
    rules: str | None = None
    """That earlier rules cleared it, sentences; empty for any other run."""
    untraced: str | None = None
    """Of a simulator: why no trace is stored, sentences; empty if one is, and for any other run."""
    rate: float | None = None
    """Evaluations per second of the running stage."""
    remaining: float | None = None
    """Estimated time left [s]; None while it cannot be estimated."""
    untimed: list[str] = []
    """The titles of stages that have not ended whose time is not part of it: they compute without evaluations."""


class RunPage(Answer):
    """A page of the run list."""

    items: list[Run]
    next_cursor: str | None
    counts: dict[str, int]
    """The numbers of runs by state and by verdict for the same filters but state and verdict, and of removed runs."""


class Validation(Answer):
    """A case simulated again by other means."""

    name: str | None = None
    step: float | None = None
    """[s]; None for a system without a step."""
    cost: float | None = None
    allowed: float | None = None
    """The tolerance, in the criterion's unit; None where values are not compared."""
    ok: bool
    """Validated: it agrees or it violates."""
    agrees: bool | None = None
    """Both differences are within tolerance, and all values on the same side of the threshold."""
    violates: bool | None = None
    """Every integration violates, however much they differ."""
    realisation: int | None = None
    """The noise seed drawn for its evaluation; None if it simulated those of the campaign."""


class Likelihood(Answer):
    """How likely a case is under the campaign's distributions, whatever the units and the number of parameters.

    All numbers are None where every point of the box is equally likely, where there is no highest density, and where
    correlated parameters are not normal, so that the highest one is not known.
    """

    density: float | None = None
    """The density as a fraction of the highest one."""
    distance: float | None = None
    """The same as a distance: sqrt(-2 ln density). Of normal distributions the distance from the mean in standard
    deviations, the reliability index of the point. None where the density is zero.
    """
    tail: float | None = None
    """The probability that a draw is no more likely than this case; of normal distributions that it is at least as far
    from the mean.
    """
    parameters: int | None = None
    """How many parameters count: all but uncorrelated uniform ones; 0 also where the density is unbounded."""
    text: str
    """The sentence as plain text."""


class LikelyViolation(Answer):
    """A violation as evaluated by a stage; it was not validated."""

    position: int
    """Of its stage."""
    index: int
    """In its stage, counted from 0."""
    cost: float
    margin: float
    parameters: dict[str, float]
    realisation: int | None = None
    """The noise seed drawn for its evaluation; None if it simulated the realisations of the campaign."""
    likelihood: Likelihood


class MostLikely(Answer):
    """The most likely of the stored violations, which is not the most likely of all."""

    violations: int
    """Stored evaluations of all stages that violate the criterion; failed ones not included."""
    case: LikelyViolation | None = None
    """None if none violates, and where likelihood does not distinguish them."""
    text: str
    """The sentence as plain text."""


class Finding(Answer):
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
    values: dict[str, float | None]
    """{name: value} of every criterion in its own sign, as stored with the trace; empty if it was not stored."""
    at_bounds: dict[str, str]
    validation: Validation | None = None
    likelihood: Likelihood | None = None
    """How likely it is under the stated distributions; None if the bounds of a parameter are not known."""
    granted: float | None = None
    """The value to state for it: of a confirmed violation the mildest of its values, if they differ."""
    violates: bool | None = None
    """Whether it violates and what evaluates it again confirms that."""


class Signoff(Answer):
    """One sign-off and its standing; it is never edited. Times are seconds since 1970."""

    id: int | None = None
    run: str | None = None
    """The run whose results were signed, R-0001: an earlier one if it is carried on."""
    name: str
    """Who signed: the account, or without accounts the name as typed."""
    typed: bool | None = None
    """Whether the name was typed on a service without accounts; no sign-in confirms it."""
    stated: str | None = None
    """The name that an earlier version let the account type as well."""
    role: str
    """The title, as typed."""
    comment: str | None = None
    digest: str | None = None
    current: bool | None = None
    """Whether the results are still those that were signed."""
    standing: str | None = None
    """`standing`: of these results, and no change is known; `carried on`: so, and a newer run repeats them."""
    reasons: list[str] = []
    """Why it is suspect: what has changed since, as clauses."""
    repeated_by: str | None = None
    """The newest run that repeats the signed one: the same campaign and code, and the same evaluations bit by bit."""
    sentence: str | None = None
    """The standing in words."""
    account: str | None = None
    """The user who was signed in to the service, also by a token."""
    user: str | None = None
    """That user, or the name of the API token."""
    own: bool | None = None
    """Whether this user also launched the run: such a sign-off is not independent."""
    created: AwareDatetime | None = None
    withdrawn: AwareDatetime | None = None
    withdrawn_by: str | None = None
    withdrawn_reason: str | None = None


class Signoffs(Answer):
    """The sign-offs of a run, oldest first, with those that it carries on, and the digest of its current results."""

    digest: str | None = None
    can_sign: bool | None = None
    """Whether the run can be signed off: it has a verdict and is not removed."""
    barred: str | None = None
    """Why the caller may not sign it off, such as having launched it; None if they may."""
    signs_as: str | None = None
    """The account under which the caller signs; None on a service without accounts, where a name is typed."""
    texts: dict[str, str] = {}
    """The requirements that the run states, by id, with the texts of now: a new sign-off is bound to them."""
    against: dict[str, str] = {}
    """How other runs speak against its verdict, by run: it `violates`, it `found` a value at or below the threshold, or
    it saw `beyond` the horizon what bars a cleared verdict.
    """
    not_carried: str | None = None
    """Why the sign-offs of the newest signed run of this campaign before it do not count here, if none does."""
    items: list[Signoff]


class TraceColumn(Answer):
    """One column of a trace."""

    name: str
    symbol: str | None = None
    unit: str
    group: str | None = None
    """`signal`: any quantity that a simulator returns over time."""
    text: str | None = None
    """One line on a signal; omitted if it has none."""


class TraceInfo(Answer):
    """A stored trace without its data."""

    name: str
    rows: int
    columns: list[TraceColumn]


class TraceData(TraceInfo):
    """Columns by name, thinned to at most `max_points` rows; the rows nearest the closest approach are kept."""

    data: dict[str, list[float | None]]


class Outcome(Answer):
    """The outcome of a run. Costs and margins are in `unit`.

    Numbers are None unless the run is done: those of a cancelled or failed run would be of an incomplete search. A
    lowest value at or below the threshold is stated all the same: `unconfirmed`.
    """

    id: str | None = None
    """R-0001"""
    name: str | None = None
    state: str
    """queued, running, cancelling, cancelled, failed, done"""
    verdict: str | None
    """cleared, violated, inconclusive"""
    error: str | None
    campaign_name: str | None = None
    campaign_digest: str | None = None
    seed: int | None = None
    """None if this version cannot read it in the stored campaign."""
    code: str | None = None
    """Digest of its identity: engine, own files, packages; None before its first stage, or if something of it is not
    identified.
    """
    unidentified: list[str] = []
    """What of its identity was not stored or cannot be read exactly."""
    clearance: str | None = None
    """Version of Clearance that ran it."""
    quantity: str | None = None
    unit: str
    threshold: float | None = None
    worst_cost: float | None = None
    margin: float | None
    """Worst value minus threshold; 0 or less violates the criterion."""
    upper_bound: float | None
    """Upper bound on P(violation), from the sample that `bound_source` names; None without one."""
    bound_source: str | None = None
    """`certify`: the independent sample of the certify stage. `certify_stated`: the same with a stated seed, which a
    user may have chosen. `search`: there is no certify stage, and the sample is a random search with the seed of the
    campaign. Nothing is cleared by the last two. None without a bound.
    """
    excluded_samples: int | None = None
    """Draws of that sample that were excluded, of which the bound says nothing, or which it counts as no violations;
    None without a bound, and in results of earlier versions.
    """
    excluded_fraction: float | None = None
    """Of all draws of that sample."""
    violations: int | None = None
    failed_samples: int | None = None
    """Of the violations: samples without a value, because their evaluation failed."""
    samples: int | None = None
    confidence: float | None
    """Of the upper bound."""
    not_sampled: bool | None = None
    """Whether nothing but an independent sample is missing to clear it."""
    earlier_rules: bool | None = None
    """Whether it is cleared by the rules of an earlier version, and `clearance audit` names what does not hold by those
    of today.
    """
    against: str | None = None
    """As of the run: which others speak against its verdict, a sentence; empty if none does."""
    policy: str | None = None
    """What the campaign's policy says of the changes since the baseline: `holds`; `fails`, which is exit code 1
    whatever the verdict; `accepts`, a violated run whose violations were all known. None without a comparison.
    """
    unconfirmed: str | None = None
    """Of a cancelled or failed run: the sentence on its lowest value, where that is at or below the threshold and thus
    speaks against a requirement without a verdict; empty otherwise.
    """
    created: AwareDatetime | None = None
    finished: AwareDatetime | None = None
    removed: bool | None = None
    """Whether it is removed from the lists."""


class SweepPoint(Answer):
    """One value and its run."""

    value: float
    run: str
    """R-0001"""
    outcome: Outcome | None
    """None if the results were purged."""


class Sweep(SweepAnswer):
    """A sweep with its runs, in ascending order of the values."""

    id: str
    """S-0001"""
    name: str
    campaign_name: str | None = None
    path: str
    """The parameter that differs between its runs."""
    title: str | None = None
    """The description of the parameter."""
    unit: str
    owner: str
    """The user who launched it, also by a token."""
    token: str | None = None
    """The name of the API token that launched it."""
    created: AwareDatetime
    runs: int
    states: dict[str, int]
    """The numbers of its runs by state and by verdict; those of which the results were purged as `purged`; of the
    cleared ones those as `contradicted` that other runs speak against.
    """
    code_warning: str | None = None
    """That its runs that are done were run by different code, or that it may differ because it is not identified,
    sentences; empty if all of them have the same.
    """
    nominal: float | None = None
    """The parameter's value in the campaign."""
    points: list[SweepPoint]
