"""Submission of runs: checked against the catalogue, given a baseline, queued once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from backend.access.own import owns
from backend.catalog.service import required
from backend.db import audit, baselines, groups, queue, sample_seeds
from backend.db.access import Visitor
from backend.db.baselines import Resolved
from backend.db.continuation import store_text
from backend.db.engine import now, read
from backend.http import bodies, keys
from backend.http.keys import Keyed
from backend.runs import reuse
from backend.runs.address import AddressParts
from backend.runs.quota import Quota, refuse_beyond
from backend.runs.requests import RunSubmit
from backend.runs.schemas import RunBaseline, RunSubmitted
from backend.runs.service import baseline, summary
from campaigns import Campaign, CampaignError, Catalogue, Problem, check
from campaigns.asked.load import load_document, load_text
from campaigns.results.baselines import CannotCompare
from campaigns.runs import RunState, run_name, run_number
from campaigns.stages.plan import most

AT_LAUNCH = "a baseline is added at launch: leave it out, and give the run next to the campaign, as baseline: R-0001"


@dataclass(frozen=True)
class Submission:
    """A campaign to run, parsed but not yet checked against the catalogue."""

    campaign: Campaign
    name: str
    tags: list[str]
    priority: int
    digest: str
    """Digest of the request, to distinguish a repeated request from another one with the same key."""
    text: str | None
    """The original text of the campaign; None if only a document was given."""
    labels: dict[str, str]
    baseline: str | None
    reuse: bool
    sample_seed: int | None
    group: str | None


def from_yaml(body: bytes, parts: AddressParts) -> Submission:
    """A submission whose body is the campaign itself."""
    campaign = bodies.yaml_campaign(body)  # first: text that is a campaign can be stored
    request = parts.with_body(RunSubmit(campaign={}, text=bodies.text(body)))
    return _submission(campaign, request, parts.digest(body))


def from_json(body: bytes, request: RunSubmit, parts: AddressParts) -> Submission:
    """A submission from JSON; raises `CampaignError`, also if its text describes another campaign."""
    campaign = load_document(request.campaign, "request")
    if request.text is not None and load_text(request.text, "text").digest != campaign.digest:
        text = "the text describes a different campaign than `campaign`: make both equal, or omit the text"
        raise CampaignError("request", [Problem("text", "", text)])
    return _submission(campaign, parts.with_body(request), parts.digest(body))


def _submission(campaign: Campaign, request: RunSubmit, digest: str) -> Submission:
    tags = campaign.tags if request.tags is None else list(dict.fromkeys(request.tags))
    if campaign.baseline is not None:
        raise CampaignError("request", [Problem("campaign.baseline", campaign.baseline.run, AT_LAUNCH)])
    name = request.name or campaign.name
    labelled = (request.labels, request.baseline, request.reuse, request.sample_seed, request.group)
    return Submission(campaign, name, tags, request.priority, digest, request.text, *labelled)


def submit(engine: sa.Engine, submission: Submission, visitor: Visitor, key: str | None, quota: Quota) -> RunSubmitted:
    """Queue a run, or return the one queued earlier with the same key; a refused request leaves no row."""
    keyed = Keyed(key, visitor.user, "submit_run", submission.digest)
    with read(engine) as reader:
        repeated = _run(keys.earlier(reader, keyed))
        if repeated is not None:
            return _answer(reader, *repeated)
        catalogue = required(reader)
        problems = check(submission.campaign, catalogue)
        if problems:
            raise CampaignError("request", problems)
        resolved = _compared(reader, submission, catalogue)
        reused = reuse.reusable(reader, resolved.campaign, submission.sample_seed) if submission.reuse else None
    with engine.begin() as writer:
        repeated = _run(keys.claimed(writer, keyed))
        if submission.group is not None and repeated is None:
            groups.lock(writer, submission.group)
        if repeated is not None:
            run_id, at = repeated
        elif reused is not None:
            run_id, at = reused, now(writer)
        else:
            refuse_beyond(writer, quota, visitor)
            run_id, at = _queue(writer, submission, resolved, visitor, catalogue), now(writer)
        if repeated is None:
            keys.keep(writer, keyed, run_name(run_id))
        cancelled = _supersede(writer, submission, visitor, run_id) if repeated is None else []
        if repeated is None and reused is None:
            audit.note(writer, visitor, "run.submitted", run_name(run_id), _noted(submission, resolved))
        for other, state in cancelled:
            noted = {"state": state, "group": submission.group, "superseded_by": run_name(run_id)}
            audit.note(writer, visitor, "run.cancelled", run_name(other), noted)
    with read(engine) as reader:
        return _answer(reader, run_id, at, resolved)


def _compared(reader: sa.Connection, submission: Submission, catalogue: Catalogue) -> Resolved:
    if submission.baseline is None:
        return Resolved(submission.campaign, None, "")
    try:
        return baselines.resolved(reader, submission.campaign, submission.baseline, catalogue)
    except CannotCompare as error:
        raise CampaignError("request", [Problem("baseline", submission.baseline, f"{error}")]) from None


def _queue(
    writer: sa.Connection, submission: Submission, resolved: Resolved, visitor: Visitor, catalogue: Catalogue
) -> int:
    stated = submission.sample_seed
    run_id = queue.submit(
        writer,
        resolved.campaign,
        name=submission.name,
        tags=submission.tags,
        owner=visitor.account,
        token=visitor.token,
        priority=submission.priority,
        planned=most(resolved.campaign),
        catalogue=catalogue,
        labelled=submission.labels,
        seed=None if stated is None else sample_seeds.requested(writer, resolved.campaign.digest, stated),
    )
    if submission.text is not None:
        store_text(writer, run_id, submission.text)
    if submission.baseline is not None:
        baselines.store(writer, run_id, submission.baseline, resolved.run_id)
    if submission.group is not None:
        groups.store(writer, run_id, submission.group)
    return run_id


def _supersede(
    writer: sa.Connection, submission: Submission, visitor: Visitor, run_id: int
) -> list[tuple[int, RunState]]:
    """Cancel the other runs of the group that have not ended and that the visitor may cancel; their new states."""
    if submission.group is None:
        return []
    found: list[tuple[int, RunState]] = []
    for other, owner in groups.active(writer, submission.group, run_id):
        if owns(visitor, owner):
            state = queue.request_cancel(writer, other)
            if state in (RunState.CANCELLING, RunState.CANCELLED):
                groups.supersede(writer, other, run_id)
                found.append((other, state))
    return found


def _noted(submission: Submission, resolved: Resolved) -> dict[str, object]:
    detail: dict[str, object] = {"campaign": resolved.campaign.digest, "name": submission.name}
    detail |= {"labels": submission.labels} if submission.labels else {}
    detail |= {} if submission.group is None else {"group": submission.group}
    return detail | ({} if submission.baseline is None else {"baseline": submission.baseline})


def _answer(reader: sa.Connection, run_id: int, at: float, resolved: Resolved | None = None) -> RunSubmitted:
    """The run; at: when it was asked for first. One that had ended by then is reused."""
    found = summary(reader, run_id)
    earlier = found.finished is not None and found.finished <= at
    reused = reuse.sentence(reader, run_id) if earlier else None
    compared = baseline(reader, run_id)
    if compared is None and resolved is not None and resolved.request:  # the run that is reused was launched without it
        compared = RunBaseline(asked=resolved.request, run=None, sentence=resolved.sentence)
    others = [run_name(other) for other in groups.superseded(reader, run_id)]
    return RunSubmitted(**dict(found), reused=reused, baseline=compared, superseded=others)


def _run(row: sa.Row[Any] | None) -> tuple[int, float] | None:
    """The run that was queued with a key, and the time stored with it."""
    return None if row is None else (run_number(row.made) or 0, float(row.created))
