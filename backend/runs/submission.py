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
    request: RunSubmit
    digest: str
    """Digest of the request, to distinguish a repeated request from another one with the same key."""

    @property
    def name(self) -> str:
        return self.request.name or self.campaign.name


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
    if campaign.baseline is not None:
        raise CampaignError("request", [Problem("campaign.baseline", campaign.baseline.run, AT_LAUNCH)])
    return Submission(campaign, request, digest)


def submit(engine: sa.Engine, submission: Submission, visitor: Visitor, key: str | None, quota: Quota) -> RunSubmitted:
    """Queue a run, or return the one queued earlier with the same key; a refused request leaves no row."""
    keyed, request = Keyed(key, visitor.user, "submit_run", submission.digest), submission.request
    with read(engine) as reader:
        repeated = _run(keys.earlier(reader, keyed))
        if repeated is not None:
            return _answer(reader, *repeated)
        catalogue = required(reader)
        problems = check(submission.campaign, catalogue)
        if problems:
            raise CampaignError("request", problems)
        resolved = _compared(reader, submission, catalogue)
        reused = reuse.reusable(reader, resolved.campaign, request.sample_seed) if request.reuse else None
    with engine.begin() as writer:
        repeated = _run(keys.claimed(writer, keyed))
        if repeated is None:
            if request.group is not None:
                groups.lock(writer, request.group)
            if reused is None:
                refuse_beyond(writer, quota, visitor)
            run_id = _queue(writer, submission, resolved, visitor, catalogue) if reused is None else reused
            repeated = run_id, now(writer)
            keys.keep(writer, keyed, run_name(run_id))
            cancelled = _supersede(writer, request.group, visitor, run_id)
            if reused is None:
                audit.note(writer, visitor, "run.submitted", run_name(run_id), _noted(submission, resolved))
            for other, state in cancelled:
                noted = {"state": state, "group": request.group, "superseded_by": run_name(run_id)}
                audit.note(writer, visitor, "run.cancelled", run_name(other), noted)
    with read(engine) as reader:
        return _answer(reader, *repeated, resolved)


def _compared(reader: sa.Connection, submission: Submission, catalogue: Catalogue) -> Resolved:
    baseline = submission.request.baseline
    if baseline is None:
        return Resolved(submission.campaign, None, "")
    try:
        return baselines.resolved(reader, submission.campaign, baseline, catalogue)
    except CannotCompare as error:
        raise CampaignError("request", [Problem("baseline", baseline, f"{error}")]) from None


def _queue(
    writer: sa.Connection, submission: Submission, resolved: Resolved, visitor: Visitor, catalogue: Catalogue
) -> int:
    request, campaign = submission.request, submission.campaign
    stated = request.sample_seed
    run_id = queue.submit(
        writer,
        resolved.campaign,
        name=submission.name,
        tags=campaign.tags if request.tags is None else list(dict.fromkeys(request.tags)),
        owner=visitor.account,
        token=visitor.token,
        priority=request.priority,
        planned=most(resolved.campaign),
        catalogue=catalogue,
        labelled=request.labels,
        seed=None if stated is None else sample_seeds.requested(writer, resolved.campaign.digest, stated),
    )
    if request.text is not None:
        store_text(writer, run_id, request.text)
    if request.baseline is not None:
        baselines.store(writer, run_id, request.baseline, resolved.run_id)
    if request.group is not None:
        groups.store(writer, run_id, request.group)
    return run_id


def _supersede(writer: sa.Connection, group: str | None, visitor: Visitor, run_id: int) -> list[tuple[int, RunState]]:
    """Cancel the other runs of the group that have not ended and that the visitor may cancel; their new states."""
    if group is None:
        return []
    found: list[tuple[int, RunState]] = []
    for other, owner in groups.active(writer, group, run_id):
        if owns(visitor, owner):
            state = queue.request_cancel(writer, other)
            if state in (RunState.CANCELLING, RunState.CANCELLED):
                groups.supersede(writer, other, run_id)
                found.append((other, state))
    return found


def _noted(submission: Submission, resolved: Resolved) -> dict[str, object]:
    detail: dict[str, object] = {"campaign": resolved.campaign.digest, "name": submission.name}
    request_options = {name: getattr(submission.request, name) for name in ("labels", "group", "baseline")}
    return detail | {name: value for name, value in request_options.items() if value}


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
