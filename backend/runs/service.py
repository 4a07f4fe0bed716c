"""Submission and details of runs. The list is in `backend.runs.listing`. Start reading at `submit`."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import sqlalchemy as sa

from backend.catalog.criteria import criteria
from backend.catalog.service import described, published, required
from backend.db import audit, queue
from backend.db.access import Visitor
from backend.db.engine import now, read
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import IdempotencyKey, Run, RunText, Stage
from backend.http import bodies
from backend.http.errors import RefusedError, not_found
from backend.runs import listing, pace
from backend.runs.earlier import terms_of
from backend.runs.schemas import RunDetail, RunSubmit, RunSummary, RunVerdict, StageDetail, StageProgress, StageSummary
from backend.runs.tombstones import refuse_purged
from backend.runs.versions import readable
from campaigns import Campaign, CampaignError, Catalogue, Problem, check
from campaigns.asked.load import load_document, load_text
from campaigns.claims import earlier
from campaigns.documents import JsonObject
from campaigns.results import SearchResult, Verdict, verdicts
from campaigns.results.remedies import Ran
from campaigns.results.verdict import VerdictWord
from campaigns.runs import run_name, run_number
from campaigns.stages.found import declared
from campaigns.stages.plan import plan
from campaigns.versions import Versions


@dataclass(frozen=True)
class Submission:
    """A campaign to run, parsed but not yet checked against the catalogue."""

    campaign: Campaign
    name: str
    tags: list[str]
    priority: int
    digest: str
    """Digest of the request body, to distinguish a repeated request from another one with the same key."""
    text: str | None
    """The original text of the campaign; None if only a document was given."""


def number(run: str) -> int:
    """The number of a run from its name, R-0001; 404 for anything else."""
    found = run_number(run)
    if found is None:
        raise not_found("run", run)
    return found


def from_yaml(body: bytes) -> Submission:
    """A submission whose body is the campaign itself."""
    return _submission(bodies.yaml_campaign(body), RunSubmit(campaign={}, text=bodies.text(body)), body)


def from_json(body: bytes, given: RunSubmit) -> Submission:
    """A submission from JSON; raises `CampaignError`, also if its text describes another campaign."""
    campaign = load_document(given.campaign, "request")
    if given.text is not None and load_text(given.text, "text").digest != campaign.digest:
        text = "the text describes a different campaign than `campaign`: make both equal, or omit the text"
        raise CampaignError("request", [Problem("text", "", text)])
    return _submission(campaign, given, body)


def _submission(campaign: Campaign, given: RunSubmit, body: bytes) -> Submission:
    tags = campaign.tags if given.tags is None else list(dict.fromkeys(given.tags))
    digest = hashlib.sha256(body).hexdigest()
    return Submission(campaign, given.name or campaign.name, tags, given.priority, digest, given.text)


def submit(engine: sa.Engine, submission: Submission, visitor: Visitor, key: str | None) -> RunSummary:
    """Queue a run, or return the one queued earlier with the same key; a refused request leaves no row."""
    with read(engine) as reader:
        catalogue = required(reader)
    problems = check(submission.campaign, catalogue)
    if problems:
        raise bodies.invalid(CampaignError("request", problems))
    with engine.begin() as writer:
        run_id = None if key is None else _repeated(writer, submission, visitor, key)
        if run_id is None:
            run_id = _queue(writer, submission, visitor, catalogue)
            if submission.text is not None:
                writer.execute(sa.insert(RunText).values(run_id=run_id, text=submission.text))
            told = {"campaign": submission.campaign.digest, "name": submission.name}
            audit.note(writer, visitor, "run.submitted", run_name(run_id), told)
            if key is not None:
                _remember(writer, submission, visitor, key, run_id)
    with read(engine) as reader:
        return summary(reader, run_id)


def _queue(writer: sa.Connection, submission: Submission, visitor: Visitor, catalogue: Catalogue) -> int:
    return queue.submit(
        writer,
        submission.campaign,
        name=submission.name,
        tags=submission.tags,
        owner=visitor.user,
        priority=submission.priority,
        planned=sum(stage.planned for stage in plan(submission.campaign)),
        catalogue=catalogue,
    )


def _repeated(writer: sa.Connection, submission: Submission, visitor: Visitor, key: str) -> int | None:
    mine = (IdempotencyKey.key == key, IdempotencyKey.user == visitor.user)
    row = writer.execute(sa.select(IdempotencyKey.body, IdempotencyKey.run_id).where(*mine)).one_or_none()
    if row is None:
        return None
    if row.body != submission.digest:
        detail = (
            f"the Idempotency-Key {key!r} was used for another request, which queued {run_name(row.run_id)}: "
            "send the same body again, or another key"
        )
        raise RefusedError(422, "idempotency-key-reused", detail)
    return int(row.run_id)


def _remember(writer: sa.Connection, submission: Submission, visitor: Visitor, key: str, run_id: int) -> None:
    values = {"key": key, "user": visitor.user, "body": submission.digest, "run_id": run_id}
    writer.execute(sa.insert(IdempotencyKey).values(**values, created=now(writer)))


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
    with readable(f"the campaign of {run_name(run_id)}"):
        campaign = Campaign.model_validate(document)
    stated = criteria(document, described(reader, run_id))
    if not base.quantity and stated:  # the installed catalogue no longer has the criterion, the stored one has
        base = base.model_copy(update={"quantity": stated[0].quantity, "unit": stated[0].unit})
    stages = progress(reader, run_id)
    rate, remaining = pace.estimate(stages) if base.state == "running" else (None, None)
    return RunDetail(
        **dict(base),
        notes=notes,
        campaign=document,
        criteria=stated,
        components_digest=snapshot,
        flown=None if versions is None else Versions.of(versions),
        plan=_plan(campaign),
        stages=stages,
        summary=_verdict(reader, run_id, campaign, parts, base.failed_evaluations),
        rate=rate,
        remaining=remaining,
    )


def _plan(campaign: Campaign) -> list[StageSummary]:
    return [
        StageSummary(kind=stage.kind, title=stage.title, description=stage.description(campaign))
        for stage in declared().values()
        if stage.planned(campaign)
    ]


def _verdict(
    reader: sa.Connection, run_id: int, asked: Campaign, parts: JsonObject | None, failed: int
) -> RunVerdict | None:
    """The stored verdict with its checks; those of an inconclusive one with their remedies."""
    if not parts or not parts.get("verdict"):
        return None
    with readable("the verdict of this run"):
        verdict = Verdict.model_validate(earlier.spoken(parts, terms_of(reader, run_id)))
    ran = _ran(reader, run_id, asked, verdict) if verdict.verdict is VerdictWord.INCONCLUSIVE else None
    checks = verdicts.described(verdict.checks, failed, ran)
    return RunVerdict.model_validate(verdict.model_dump() | {"checks": checks})


def _ran(reader: sa.Connection, run_id: int, asked: Campaign, verdict: Verdict) -> Ran | None:
    """What remedies are derived from; None if a stage has a result that this version cannot read."""
    try:
        found = [stage.result for stage in stages(reader, run_id)]
    except RefusedError:
        return None
    searches = [result for result in found if isinstance(result, SearchResult)]
    installed = published(reader)
    methods = [] if installed is None else [method.name for method in installed.methods]
    return Ran(asked, searches, verdict.statistics, methods)


def progress(reader: sa.Connection, run_id: int) -> list[StageProgress]:
    """The state of a run's stages, without their results."""
    columns = (getattr(Stage, name) for name in StageProgress.model_fields)
    rows = reader.execute(sa.select(*columns).where(Stage.run_id == run_id).order_by(Stage.position))
    return [StageProgress.model_validate(dict(row._mapping)) for row in rows]


def stages(reader: sa.Connection, run_id: int) -> list[StageDetail]:
    """The stages of a run with their results, or 404."""
    require(reader, run_id)
    columns = (getattr(Stage, name) for name in StageDetail.model_fields)
    rows = reader.execute(sa.select(*columns).where(Stage.run_id == run_id).order_by(Stage.position))
    with readable(f"a result of {run_name(run_id)}"):
        terms = terms_of(reader, run_id)
        return [StageDetail.model_validate(earlier.spoken(dict(row._mapping), terms)) for row in rows]


def require(reader: sa.Connection, run_id: int) -> None:
    """Raise 404 if there is no such run, 410 if it was purged."""
    refuse_purged(reader, run_id)
    if reader.scalar(sa.select(Run.id).where(Run.id == run_id)) is None:
        raise not_found("run", run_name(run_id))


def campaign(reader: sa.Connection, run_id: int) -> Campaign:
    """The campaign of a run, or 404."""
    query = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest)
    document = reader.scalar(query.where(Run.id == run_id, Run.purged.is_(None)))
    if document is None:
        require(reader, run_id)
    with readable(f"the campaign of {run_name(run_id)}"):
        return Campaign.model_validate(document)
