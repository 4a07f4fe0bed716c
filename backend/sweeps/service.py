"""Launching, reading and cancelling sweeps."""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import sqlalchemy as sa

from backend.access.own import require_own
from backend.catalog.service import required
from backend.db import audit, numbers, queue
from backend.db.access import Visitor
from backend.db.engine import ask, now
from backend.db.tables import Run, Sweep, SweepRun
from backend.http import keys
from backend.http.errors import existing
from backend.http.keys import Keyed
from backend.runs import edits
from backend.runs.outcomes import outcomes
from backend.runs.quota import Quota, refuse_beyond
from backend.runs.violations import against
from backend.sweeps import code
from backend.sweeps.schemas import PURGED, SweepDetail, SweepPoint, SweepSubmit, SweepSummary
from campaigns import Campaign, CampaignError, Catalogue, Problem, check
from campaigns.asked.load import load_document
from campaigns.catalogue import ParameterEntry
from campaigns.checked import texts
from campaigns.checked.check import parameters
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState, run_name, sweep_name, sweep_number
from campaigns.stages.plan import most

LONGEST = 120
"""Characters of a run's name."""


@dataclass(frozen=True)
class Submission:
    """A sweep to launch, parsed but not yet checked against the catalogue."""

    campaign: Campaign
    request: SweepSubmit
    body: bytes

    @property
    def digest(self) -> str:
        """The digest of the body, which distinguishes a repeated request from another one with the same key."""
        return hashlib.sha256(self.body).hexdigest()


def number(sweep: str) -> int:
    """The number of a sweep from its name, S-0001; 404 for anything else."""
    return existing(sweep_number(sweep), "sweep", sweep)


def submit(engine: sa.Engine, submission: Submission, visitor: Visitor, key: str | None, quota: Quota) -> SweepDetail:
    """Queue all runs in one transaction, or return the sweep launched earlier with the same key; `CampaignError`."""
    catalogue = ask(engine, required)
    campaigns = variants(submission.campaign, submission.request.path, submission.request.values, catalogue)
    keyed = Keyed(key, visitor.user, "submit_sweep", submission.digest)
    with engine.begin() as writer:
        repeated = keys.claimed(writer, keyed)
        if repeated is None:
            refuse_beyond(writer, quota, visitor, len(campaigns))
            sweep_id = _launch(writer, submission, campaigns, visitor, catalogue)
            keys.keep(writer, keyed, sweep_name(sweep_id))
        else:
            sweep_id = number(repeated.made)
    return ask(engine, lambda reader: detail(reader, sweep_id))


def _launch(
    writer: sa.Connection,
    submission: Submission,
    campaigns: list[Campaign],
    visitor: Visitor,
    catalogue: Catalogue,
) -> int:
    options, base = submission.request, submission.campaign
    entry, nominal = described(base, options.path, catalogue)
    name = options.name or base.name
    row = {
        "name": name,
        "campaign_name": base.name,
        "path": options.path,
        "title": entry.text[:400],
        "unit": entry.unit,
        "nominal": nominal if math.isfinite(nominal) else None,
        "owner": visitor.account,
        "token": visitor.token,
        "created": now(writer),
    }
    row |= numbers.following(writer, Sweep)
    sweep_id = int(writer.execute(sa.insert(Sweep).values(**row).returning(Sweep.id)).scalar_one())
    runs, notes = [], []
    for position, (value, campaign) in enumerate(zip(options.values, campaigns, strict=True)):
        run_id = queue.submit(
            writer,
            campaign,
            name=_named(name, options.path, value, entry.unit),
            tags=campaign.tags if options.tags is None else list(dict.fromkeys(options.tags)),
            owner=visitor.account,
            token=visitor.token,
            priority=options.priority,
            planned=most(campaign),
            catalogue=catalogue,
            labelled=options.labels,
        )
        runs.append({"sweep_id": sweep_id, "position": position, "value": value, "run_id": run_id})
        noted = {"campaign": campaign.digest, "name": name, "sweep": sweep_name(sweep_id), options.path: value}
        notes.append((run_id, noted))
    writer.execute(sa.insert(SweepRun), runs)
    for run_id, noted in notes:
        audit.note(writer, visitor, "run.submitted", run_name(run_id), noted)
    return sweep_id


def _named(name: str, path: str, value: float, unit: str) -> str:
    """The name of a run; a long name of the sweep is cut, its value never."""
    ending = f", {path} = {value:.15g} {unit}".rstrip()[:LONGEST]
    return f"{name[: max(0, LONGEST - len(ending))]}{ending}"


def listed(reader: sa.Connection, limit: int) -> list[SweepSummary]:
    """The newest sweeps, newest first."""
    rows = reader.execute(sa.select(Sweep.__table__).order_by(Sweep.id.desc()).limit(limit)).mappings().all()
    of = sa.select(SweepRun.sweep_id, Run.id, Run.state, Run.verdict, Run.purged).join(Run, Run.id == SweepRun.run_id)
    members: dict[int, list[sa.Row[int, int, str, str | None, float | None]]] = {row["id"]: [] for row in rows}
    for member in reader.execute(of.where(SweepRun.sweep_id.in_(list(members)))):
        members[member.sweep_id].append(member)
    every = chain.from_iterable(members.values())
    speaking = against(reader, [one.id for one in every if one.verdict == VerdictWord.CLEARED])
    codes = code.of_sweeps(reader, members)
    found = []
    for row in rows:
        own = members[row["id"]]
        words = [_words(one.state, one.verdict, one.id in speaking) if one.purged is None else [PURGED] for one in own]
        found.append(_summary(row, words, codes[row["id"]]))
    return found


def _words(state: str, verdict: str | None, against: bool) -> list[str]:
    """What a run is counted as."""
    contradicted = ["contradicted"] if against and verdict == VerdictWord.CLEARED else []
    return [state, *filter(None, [verdict]), *contradicted]


def detail(reader: sa.Connection, sweep_id: int) -> SweepDetail:
    """One sweep with the outcomes of its runs, or 404."""
    found = reader.execute(sa.select(Sweep.__table__).where(Sweep.id == sweep_id)).mappings().one_or_none()
    row = existing(found, "sweep", sweep_name(sweep_id))
    of = sa.select(SweepRun.value, SweepRun.run_id).where(SweepRun.sweep_id == sweep_id).order_by(SweepRun.value)
    members = reader.execute(of).all()
    known = {found.id: found for found in outcomes(reader, [Run.id.in_([member.run_id for member in members])])}
    points = [
        SweepPoint(value=member.value, run=run_name(member.run_id), outcome=known.get(run_name(member.run_id)))
        for member in members
    ]
    ends = [point.outcome for point in points]
    codes = Counter(end.code for end in ends if end is not None and end.state == RunState.DONE)
    words = [[PURGED] if end is None else _words(end.state, end.verdict, bool(end.against)) for end in ends]
    summary = _summary(row, words, codes)
    return SweepDetail(**dict(summary), nominal=row["nominal"], points=points)


def cancel(engine: sa.Engine, sweep_id: int, visitor: Visitor) -> SweepDetail:
    """Cancel all runs of a sweep that have not ended; 404 if there is no such sweep, 403 if it is another user's."""
    with engine.begin() as writer:
        owner = writer.scalar(sa.select(Sweep.owner).where(Sweep.id == sweep_id))
        require_own(visitor, owner, sweep_name(sweep_id))
        of = sa.select(Run.id).join(SweepRun, SweepRun.run_id == Run.id)
        # Runs of which the results were purged have ended.
        active = of.where(SweepRun.sweep_id == sweep_id, Run.purged.is_(None))
        edits.cancelled(writer, writer.scalars(active).all(), visitor, sweep=sweep_name(sweep_id))
    return ask(engine, lambda reader: detail(reader, sweep_id))


def _summary(row: sa.RowMapping, words: Sequence[list[str]], codes: Counter[str | None]) -> SweepSummary:
    """words: those of each of its runs; codes: how many runs that are done have each code."""
    same = ("name", "campaign_name", "path", "title", "unit", "owner", "token", "created")
    states = dict(Counter(chain.from_iterable(words)))
    values = {name: row[name] for name in same}
    warning = code.warning(codes)
    return SweepSummary(id=sweep_name(row["id"]), **values, runs=len(words), states=states, code_warning=warning)


SOURCE = "request"


def variants(campaign: Campaign, path: str, values: Sequence[float], catalogue: Catalogue) -> list[Campaign]:
    """One campaign for each value, in order; raises `CampaignError` with every problem of every one of them."""
    problems = check(campaign, catalogue) or list(_refused(campaign, path, catalogue))
    if problems:
        raise CampaignError(SOURCE, problems)
    made = []
    for i, value in enumerate(values):
        try:
            variant = load_document(_with(campaign, path, value), SOURCE)
            found = check(variant, catalogue)
        except CampaignError as error:
            found = error.problems
        else:
            made.append(variant)
        problems += [Problem(f"values.{i}", f"{value:.15g}", f"{p.field}: {p.message}") for p in found]
    if problems:
        raise CampaignError(SOURCE, problems)
    return made


def described(campaign: Campaign, path: str, catalogue: Catalogue) -> tuple[ParameterEntry, float]:
    """The entry of the parameter, and its value in the campaign."""
    return parameters(campaign, catalogue)[path]


def _refused(campaign: Campaign, path: str, catalogue: Catalogue) -> Iterator[Problem]:
    if campaign.baseline is not None:
        yield Problem("campaign.baseline", campaign.baseline.run, "a sweep has no baseline; leave it out")
    known = parameters(campaign, catalogue)
    fixed = [name for name in known if name not in campaign.uncertain]
    if path in campaign.uncertain:
        text = "this parameter is uncertain, so every run searches over it; sweep one that is fixed"
        yield Problem("path", path, f"{text} ({', '.join(fixed[:6])}, ...)")
    elif path not in known:
        yield Problem("path", path, f"the campaign has no such parameter; {texts.known(path, fixed)}")


def _with(campaign: Campaign, path: str, value: float) -> dict[str, Any]:
    document = campaign.document()
    first, _, rest = path.partition(".")
    place: Any = document if first in ("criterion", "objectives", "simulator") else document["scenario"]
    place = place[first]
    if isinstance(place, list):
        number, _, rest = rest.partition(".")
        place = place[int(number)]
    (place if first in ("start", "goal") else place["parameters"])[rest] = value
    return document
