"""Details of runs; the list is in `backend.runs.listing`, submission in `backend.runs.submission`. Read `detail`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sqlalchemy as sa
from pydantic import ValidationError

from backend.catalog.criteria import criteria
from backend.catalog.service import bounds, described, published
from backend.db import audit, baselines
from backend.db.engine import once
from backend.db.tables import Audit, CampaignRow, Run, Stage
from backend.http.errors import RefusedError, existing
from backend.http.versions import readable
from backend.runs import counts, identity, listing, sample_kind
from backend.runs.earlier import terms_of
from backend.runs.schemas import (
    HistoryEntry,
    RunBaseline,
    RunDetail,
    RunSummary,
    RunVerdict,
    StageDetail,
    StageProgress,
    StageSummary,
)
from backend.runs.tombstones import refuse_purged
from backend.runs.traces import no_trace
from backend.runs.violations import against
from campaigns import Campaign
from campaigns.asked.sample_bound import bound
from campaigns.checked import best_bound
from campaigns.checked.expected import computing
from campaigns.claims import earlier
from campaigns.claims.lowest_value import unconfirmed
from campaigns.claims.stages.sample import STATED_SEED, Drawn, so_far
from campaigns.limits import DRAWS
from campaigns.results import Verdict, verdicts
from campaigns.results.remedies import Ran
from campaigns.results.sample import SoFar
from campaigns.results.verdict import VerdictWord, by_earlier_rules
from campaigns.runs import RunState, StageState, run_name, run_number
from campaigns.stages.found import declared
from campaigns.versions import Versions, undigested


def number(run: str) -> int:
    """The number of a run from its name, R-0001; 404 for anything else."""
    return existing(run_number(run), "run", run)


def summary(reader: sa.Connection, run_id: int) -> RunSummary:
    """The summary of one run, or 404."""
    found = listing.summaries(reader, Run.id == run_id)
    if not found:
        require(reader, run_id)
    return found[0]


def detail(reader: sa.Connection, run_id: int) -> RunDetail:
    """One run with its campaign, stages and estimated remaining time."""
    base = summary(reader, run_id)
    document, parts, notes, snapshot, versions = reader.execute(
        sa.select(CampaignRow.document, Run.summary, Run.notes, Run.snapshot, Run.flown)
        .join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        .where(Run.id == run_id)
    ).one()
    with readable(f"the campaign of {run_name(run_id)}", reader, run_id):
        campaign = Campaign.model_validate(document)
    stated = criteria(document, described(reader, run_id))
    if not base.quantity and stated:  # the installed catalogue no longer has the criterion, the stored one has
        base = base.model_copy(update={"quantity": stated[0].quantity, "unit": stated[0].unit})
    stages = progress(reader, run_id)
    verdict = _verdict(reader, run_id, campaign, parts, base.failed_evaluations)
    if verdict is not None:  # stored as text, it has the bound as earlier versions rounded it
        base = base.model_copy(update={"reason": verdict.reason})
    speaking = against(reader, [run_id])[run_id] if base.against else []
    pace = _pace(stages, computing(campaign)) if base.state == RunState.RUNNING else NO_PACE
    return RunDetail(
        **dict(base),
        not_continuable=_not_continuable(reader, run_id, base, campaign),
        notes=notes,
        baseline=baseline(reader, run_id),
        campaign=document,
        criteria=stated,
        components_digest=snapshot,
        flown=None if versions is None else Versions.of(versions),
        undigested=undigested(versions, any(s.evaluations or s.state != StageState.WAITING for s in stages)),
        identity=identity.of_run(reader, run_id),
        plan=[
            StageSummary(
                kind=stage.kind,
                title=stage.title,
                description=stage.description(campaign),
            )
            for stage in declared().values()
            if stage.planned(campaign)
        ],
        stages=stages,
        summary=verdict,
        unconfirmed=unconfirmed(base.state, base.worst_cost, base.threshold, base.unit),
        against_runs=[run_name(one.run_id) for one in speaking],
        rules=by_earlier_rules(base.id) if base.earlier_rules else "",
        untraced="" if campaign.simulator is None else no_trace(reader, run_id),
        rate=pace.rate,
        remaining=pace.remaining,
        untimed=pace.untimed,
    )


def _not_continuable(reader: sa.Connection, run_id: int, base: RunSummary, campaign: Campaign) -> str | None:
    installed = None if base.other_code is None else published(reader)
    return None if installed is None else identity.not_continuable(reader, run_id, campaign, installed)


def baseline(reader: sa.Connection, run_id: int) -> RunBaseline | None:
    launched = baselines.of_run(reader, run_id)
    if launched is None:
        return None
    request, found = launched
    if found is None:
        return RunBaseline(asked=request, run=None, sentence=baselines.none_found(request))
    name = run_name(found)
    how = (
        "" if request == name else f", the newest run with the label {request.removeprefix(baselines.LABEL)} at launch"
    )
    return RunBaseline(asked=request, run=name, sentence=f"Baseline: {name}{how}.")


def _verdict(
    reader: sa.Connection, run_id: int, campaign: Campaign, parts: dict[str, object] | None, failed: int
) -> RunVerdict | None:
    """The stored verdict with its checks; those of an inconclusive one with their remedies."""
    if not parts or not parts.get("verdict"):
        return None
    with readable(f"the verdict of {run_name(run_id)}", reader, run_id):
        verdict = Verdict.model_validate(earlier.spoken(parts, terms_of(reader, run_id)))
    ran = _ran(reader, run_id, campaign, verdict) if verdict.verdict is VerdictWord.INCONCLUSIVE else None
    checks = verdicts.described(verdict.checks, failed, ran)
    return RunVerdict.model_validate(verdict.model_dump() | {"checks": checks})


def _ran(reader: sa.Connection, run_id: int, campaign: Campaign, verdict: Verdict) -> Ran | None:
    """What remedies are derived from; None if a stage has a result that this version cannot read."""
    try:
        found = [stage.result for stage in stages(reader, run_id)]
    except RefusedError:
        return None
    installed = published(reader)
    return Ran(campaign, found, verdict.statistics, [] if installed is None else installed.methods)


def progress(reader: sa.Connection, run_id: int) -> list[StageProgress]:
    """The state of a run's stages, without their results."""
    rows = reader.execute(
        sa.select(*counts.columns(StageProgress)).where(Stage.run_id == run_id).order_by(Stage.position)
    )
    drawn = _so_far(reader, run_id)
    return [StageProgress.model_validate({**row._mapping, "so_far": drawn.get(row.position)}) for row in rows]


def stages(reader: sa.Connection, run_id: int) -> list[StageDetail]:
    """The stages of a run with their results, or 404."""
    require(reader, run_id)
    rows = reader.execute(
        sa.select(*counts.columns(StageDetail)).where(Stage.run_id == run_id).order_by(Stage.position)
    )
    with readable(f"a result of {run_name(run_id)}", reader, run_id):
        terms = terms_of(reader, run_id)
        return [StageDetail.model_validate(earlier.spoken(dict(row._mapping), terms)) for row in rows]


def require(reader: sa.Connection, run_id: int) -> None:
    """Raise 404 if there is no such run, 410 if it was purged."""
    once(reader, ("required", run_id), lambda: _required(reader, run_id))


def _required(reader: sa.Connection, run_id: int) -> None:
    refuse_purged(reader, run_id)
    existing(reader.scalar(sa.select(Run.id).where(Run.id == run_id)), "run", run_name(run_id))


def campaign(reader: sa.Connection, run_id: int) -> Campaign:
    """The campaign of a run, or 404."""
    return once(reader, ("campaign", run_id), lambda: _campaign(reader, run_id))


def _campaign(reader: sa.Connection, run_id: int) -> Campaign:
    query = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest)
    document = reader.scalar(query.where(Run.id == run_id, Run.purged.is_(None)))
    if document is None:
        require(reader, run_id)
    with readable(f"the campaign of {run_name(run_id)}", reader, run_id):
        return Campaign.model_validate(document)


MOST_ENTRIES = 500
"""Of the history of a run."""


def history(reader: sa.Connection, run_id: int) -> list[HistoryEntry]:
    """The newest `MOST_ENTRIES` entries of a run, newest first, also of a purged one; 404 if there is no such run."""
    existing(reader.scalar(sa.select(Run.id).where(Run.id == run_id)), "run", run_name(run_id))
    of = sa.select(Audit.at, Audit.user, audit.ACCOUNT, Audit.via, Audit.action, Audit.detail)
    rows = reader.execute(of.where(Audit.subject == run_name(run_id)).order_by(Audit.id.desc()).limit(MOST_ENTRIES))
    return [HistoryEntry.model_validate(dict(row._mapping)) for row in rows]


FEWEST = 8
"""With fewer evaluations than this no speed is reported."""


class _Pace(NamedTuple):
    """Evaluations per second of the running stage, the time left [s] if every stage uses its whole budget, and the
    titles of stages whose time is not part of it."""

    rate: float | None
    remaining: float | None
    untimed: list[str]


NO_PACE = _Pace(None, None, [])


def _pace(stages: Sequence[StageProgress], computing: Sequence[str]) -> _Pace:
    """The pace of a running run; computing: the kinds of stages that compute without evaluations.

    A stage that has just started is assumed to be as fast as the run so far. Stages that end by their own rule finish
    earlier.
    """
    left = [s for s in stages if s.state != StageState.DONE]
    running = next((s for s in left if s.state == StageState.RUNNING), None)
    if running is None:
        return NO_PACE
    untimed = [s.title for s in left if s.kind in computing]
    speed = _speed([running]) or _speed([s for s in stages if s.position and s.kind not in computing])
    if speed is None:
        return _Pace(None, None, untimed)
    seconds = sum(s.left for s in left) / speed
    return _Pace(None if running.kind in computing else speed, seconds, untimed)


def _speed(stages: Sequence[StageProgress]) -> float | None:
    evaluations, seconds = sum(s.evaluations for s in stages), sum(s.seconds for s in stages)
    return evaluations / seconds if evaluations >= FEWEST and seconds > 0 else None


def _so_far(reader: sa.Connection, run_id: int) -> dict[int, SoFar]:
    """What a sample shows while it is drawn, of which only the lowest evaluations are stored.

    By the position of the stage; none for a run without such a sample, once it is whole, or if its campaign or
    descriptions were stored by another version."""
    drawing = (Stage.run_id == run_id, Stage.counted > 0, Stage.state == StageState.RUNNING)
    columns = (Stage.position, Stage.planned, Stage.counted, Stage.excluded, Stage.violations, Stage.failed)
    rows = reader.execute(sa.select(*columns).where(*drawing)).all()
    if not rows:
        return {}
    of = sa.select(CampaignRow.document, sample_kind.STATED.label("stated"))
    run = reader.execute(of.join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)).one()
    seed = STATED_SEED if run.stated else ""
    try:
        campaign = Campaign.model_validate(run.document)
        outside = _outside(reader, run_id, campaign)
    except (ValidationError, RefusedError):
        return {}
    return {row.position: _shown(row, campaign.confidence, outside, seed) for row in rows if row.counted > row.excluded}


def _outside(reader: sa.Connection, run_id: int, campaign: Campaign) -> float | None:
    """The probability beyond the bounds, which is part of the bound; None if the bounds are not known here."""
    known = bounds(campaign, described(reader, run_id)) if best_bound.tailed(campaign) else {}
    return best_bound.outside(campaign, {path: (low, high) for path, (_, low, high) in known.items()})


def _shown(row: Any, confidence: float, outside: float | None, seed: str) -> SoFar:
    samples = row.counted - row.excluded
    drawn_at_most = DRAWS * row.planned * samples // row.counted  # if as many of the others are excluded
    whole, beyond = max(min(row.planned, drawn_at_most), samples), outside or 0.0
    now, end = (min(1.0, bound(row.violations, size, confidence) + beyond) for size in (samples, whole))
    drawn = Drawn(row.violations, samples, confidence, outside, row.excluded, seed, row.failed)
    return SoFar(
        samples=samples,
        violations=row.violations,
        failed=row.failed,
        upper_bound=now,
        at_end=end,
        within_bounds=outside is None,
        statement=so_far(drawn, now, whole - samples, end),
    )
