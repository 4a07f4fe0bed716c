"""The runs of a campaign in time, with changes marked (`trend`), and other runs with the same input (`related`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import sqlalchemy as sa

from backend.db import labels
from backend.db.engine import chunks
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run, RunRequirement
from backend.http.errors import RefusedError, existing
from backend.runs import identity
from backend.runs.facets import labels_of
from backend.runs.outcomes import Outcome, outcomes
from backend.runs.question import asked_again
from backend.runs.service import require
from backend.runs.violations import sentence_of
from backend.trends.schemas import Difference, RelatedRun, RelatedRuns, Trend, TrendRun
from campaigns import Problem
from campaigns.asked.requirements import definition
from campaigns.identity.identity import UNSTORED, Change, Identity, changes
from campaigns.runs import run_name, run_number


def trend(
    reader: sa.Connection, digest: str | None, name: str | None, limit: int, label: Sequence[tuple[str, str]] = ()
) -> Trend:
    """The trend of one campaign, by its digest or by its name; 422 unless exactly one is given.

    404 for an unknown digest; a name that no campaign has is one without runs, as before the first run.

    Removed runs are omitted, and from the trend of a name the variants of sweeps, which are of other values. label:
    only runs with these labels, of which those of one key are alternatives.
    """
    if (digest is None) == (name is None):
        message = "give either `campaign`, a digest, or `name`, the name of campaigns"
        raise RefusedError("invalid-request", message, [Problem("campaign", digest or "", message)])
    if digest is not None:
        known = reader.scalar(sa.select(CampaignRow.name).where(CampaignRow.digest == digest))
        name = existing(known, "campaign with the digest", digest)
        wanted = Run.campaign_digest == digest
    else:
        wanted = Run.campaign_digest.in_(sa.select(CampaignRow.digest).where(CampaignRow.name == name))
    every, narrowed = (wanted, Run.removed.is_(None), Run.purged.is_(None)), labels.conditions(label)
    there = every if digest is not None else (*every, ~in_sweep())
    conditions = (*there, *narrowed)
    total = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(*conditions)) or 0
    with_sweeps = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(*every, *narrowed)) or 0
    found = outcomes(reader, conditions, limit)
    return Trend(
        name=name or "",
        digest=digest,
        campaigns=_campaigns(reader, conditions),
        labels=labels_of(reader, *there),
        runs=_marked(reader, found[::-1]),
        total=total,
        sweeps=with_sweeps - total,
    )


def _campaigns(reader: sa.Connection, conditions: Sequence[sa.ColumnElement[bool]]) -> int:
    """How many campaigns the runs have that differ in more than the baseline."""
    digests = reader.scalars(sa.select(Run.campaign_digest).where(*conditions).distinct()).all()
    baseline = CampaignRow.document["baseline"]["run"].as_string().is_not(None)
    added = any(
        reader.scalar(sa.select(CampaignRow.digest).where(CampaignRow.digest.in_(some), baseline).limit(1))
        for some in chunks(digests)
    )
    return len(set(_definitions(reader, digests).values())) if added else len(digests)


def _definitions(reader: sa.Connection, digests: Iterable[str]) -> dict[str, str]:
    """The definition of each campaign, by its digest."""
    found: dict[str, str] = {}
    for some in chunks(set(digests)):
        of = sa.select(CampaignRow.digest, CampaignRow.document).where(CampaignRow.digest.in_(some))
        found |= {digest: definition(document) for digest, document in reader.execute(of)}
    return found


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
    stated, labelled = _stated(reader, found), _labelled(reader, found)
    known = identity.of_runs(reader, [run_number(outcome.id) or 0 for outcome in found])
    defined = _definitions(reader, (outcome.campaign_digest for outcome in found))
    runs: list[TrendRun] = []
    code: Identity | None = None
    coded, before = "", ""
    for outcome in found:
        now, own = known.get(run_number(outcome.id) or 0), outcome.campaign_digest
        apart: list[Change] = []
        if code is not None and now is not None:
            apart = identity.apart(reader, code, now, coded == own, defined[coded] == defined[own])
        other = bool(before) and defined[before] != defined[own]
        runs.append(
            TrendRun(
                **dict(outcome),
                code_changed=bool(apart),
                code_changes=identity.names(apart),
                campaign_changed=other,
                requirements=stated.get(outcome.id, []),
                labels=labelled.get(outcome.id, {}),
            )
        )
        code, coded, before = now or code, own if now else coded, own
    return runs


MOST = 50
"""Runs that are listed; all are counted."""


def related(reader: sa.Connection, run_id: int) -> RelatedRuns:
    """Runs of the same campaign with any code, and with another seed of the same or an unknown code.

    Removed runs are omitted. 404 if there is no such run, 410 if it was purged.
    """
    require(reader, run_id)
    (own,) = outcomes(reader, [Run.id == run_id])
    ids = _ids(reader, run_id, own.campaign_digest)
    found = outcomes(reader, [Run.id.in_(ids[:MOST])])
    known = identity.of_runs(reader, [run_id, *ids[:MOST]])
    return RelatedRuns(
        runs=[_related(reader, own, known.get(run_id), other, known.get(run_number(other.id) or 0)) for other in found],
        total=len(ids),
        question=asked_again(reader, run_id),
        against=sentence_of(reader, run_id),
    )


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
