"""GET /runs/{run}/related, runs with the same input, and /trends of a campaign, with changes marked."""

from __future__ import annotations

from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Query
from pydantic import Field

from backend.db import labels
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run, RunRequirement
from backend.http.deps import Reader
from backend.http.errors import RefusedError, not_found, problems
from backend.http.schema import RunName
from backend.runs import identity
from backend.runs.facets import labels_of
from backend.runs.filters import labelled
from backend.runs.outcomes import Outcome, outcomes
from backend.runs.question import asked_again
from backend.runs.service import number, require
from backend.trends.schemas import Difference, RelatedRun, RelatedRuns, Trend, TrendRun
from campaigns import Problem
from campaigns.identity.identity import UNSTORED, Identity, changes
from campaigns.runs import run_name, run_number

router = APIRouter(tags=["runs"])

MOST = 50
"""Related runs that are listed; all are counted."""


@router.get("/runs/{run}/related", responses=problems("not-found", "purged"))
def list_related(run: RunName, reader: Reader) -> RelatedRuns:
    """Other runs with the same campaign, and those that differ in one thing: the seed or the code."""
    run_id = number(run)
    require(reader, run_id)
    (own,) = outcomes(reader, [Run.id == run_id])
    ids = _ids(reader, run_id, own.campaign_digest)
    found = outcomes(reader, [Run.id.in_(ids[:MOST])])
    known = identity.of_runs(reader, [run_id, *ids[:MOST]])
    return RelatedRuns(
        runs=[_related(reader, own, known.get(run_id), other, known.get(run_number(other.id) or 0)) for other in found],
        total=len(ids),
        question=asked_again(reader, run_id),
    )


@router.get("/trends", responses=problems("not-found"))
def get_trend(
    reader: Reader,
    campaign: Annotated[str | None, Query(max_length=64, description="A campaign by its digest.")] = None,
    name: Annotated[str | None, Query(max_length=120, description="All campaigns of this name.")] = None,
    label: Annotated[
        list[Annotated[str, Field(max_length=300)]] | None,
        Query(max_length=50, description="Labels as KEY=VALUE: alternatives of one key, every key required."),
    ] = None,
    limit: Annotated[int, Query(ge=1, le=500, description="Maximum number of runs, the newest.")] = 200,
) -> Trend:
    """The runs of a campaign in time: verdicts, worst margins, probability bounds, and changes of the code."""
    # 404 for an unknown digest; a name that no campaign has is one without runs, as before the first run. Removed runs
    # are omitted, and from the trend of a name the variants of sweeps, which are of other values.
    pairs = labelled(label or ())
    if (campaign is None) == (name is None):
        message = "give either `campaign`, a digest, or `name`, the name of campaigns"
        raise RefusedError("invalid-request", message, [Problem("campaign", campaign or "", message)])
    if campaign is not None:
        name = reader.scalar(sa.select(CampaignRow.name).where(CampaignRow.digest == campaign))
        if name is None:
            raise not_found("campaign with the digest", campaign)
        wanted = Run.campaign_digest == campaign
    else:
        wanted = Run.campaign_digest.in_(sa.select(CampaignRow.digest).where(CampaignRow.name == name))
    every, narrowed = (wanted, Run.removed.is_(None), Run.purged.is_(None)), labels.conditions(pairs)
    there = every if campaign is not None else (*every, ~in_sweep())
    conditions = (*there, *narrowed)
    numbers = sa.select(sa.func.count(), sa.func.count(sa.distinct(Run.campaign_digest))).where(*conditions)
    total, campaigns = reader.execute(numbers).one()
    with_sweeps = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(*every, *narrowed)) or 0
    found = outcomes(reader, conditions, limit)
    return Trend(
        name=name or "",
        digest=campaign,
        campaigns=campaigns,
        labels=labels_of(reader, *there),
        runs=_marked(reader, found[::-1]),
        total=total,
        sweeps=with_sweeps - total,
    )


def _stated(reader: sa.Connection, found: list[Outcome]) -> dict[str, list[str]]:
    ids = [run_number(outcome.id) for outcome in found]
    of = sa.select(RunRequirement.run_id, RunRequirement.requirement).where(RunRequirement.run_id.in_(ids))
    stated: dict[str, list[str]] = {}
    for run_id, requirement in reader.execute(of.order_by(RunRequirement.requirement)):
        stated.setdefault(run_name(run_id), []).append(requirement)
    return stated


def _labelled(reader: sa.Connection, found: list[Outcome]) -> dict[str, dict[str, str]]:
    by_run = labels.of_runs(reader, [number for one in found if (number := run_number(one.id)) is not None])
    return {run_name(run_id): own_labels for run_id, own_labels in by_run.items()}


def _marked(reader: sa.Connection, found: list[Outcome]) -> list[TrendRun]:
    """found: the oldest first."""
    stated, own = _stated(reader, found), _labelled(reader, found)
    known = identity.of_runs(reader, [run_number(outcome.id) or 0 for outcome in found])
    runs: list[TrendRun] = []
    code: Identity | None = None
    campaign = None
    for outcome in found:
        now = known.get(run_number(outcome.id) or 0)
        apart = [] if code is None or now is None else identity.apart(reader, code, now)
        other = campaign is not None and campaign != outcome.campaign_digest
        runs.append(
            TrendRun(
                **dict(outcome),
                code_changed=bool(apart),
                code_changes=identity.names(apart),
                campaign_changed=other,
                requirements=stated.get(outcome.id, []),
                labels=own.get(outcome.id, {}),
            )
        )
        code, campaign = now or code, outcome.campaign_digest
    return runs


def _ids(reader: sa.Connection, run_id: int, digest: str) -> list[int]:
    """The runs of the campaign, and of those that differ in the seed alone unless their code is known to differ as
    well; the newest first."""
    seedless = reader.scalar(sa.select(CampaignRow.seedless).where(CampaignRow.digest == digest))
    same = Run.campaign_digest == digest
    wanted = same if seedless is None else sa.or_(same, CampaignRow.seedless == seedless)
    of = sa.select(Run.id, Run.campaign_digest).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    of = of.where(Run.id != run_id, Run.removed.is_(None), Run.purged.is_(None), wanted)
    rows = reader.execute(of.order_by(Run.id.desc())).all()
    known = identity.of_runs(reader, [run_id, *(row.id for row in rows if row.campaign_digest != digest)])
    then = known.get(run_id, UNSTORED)
    return [row.id for row in rows if row.campaign_digest == digest or not changes(then, known.get(row.id, UNSTORED))]


def _related(
    reader: sa.Connection, own: Outcome, then: Identity | None, other: Outcome, now: Identity | None
) -> RelatedRun:
    apart = [] if then is None or now is None else identity.apart(reader, then, now)
    differs: list[Difference] = ["seed"] if other.campaign_digest != own.campaign_digest else []
    return RelatedRun(
        **dict(other),
        differs=[*differs, "code"] if apart else differs,
        code_changes=identity.names(apart),
        code_known=own.code is not None and other.code is not None,
    )
