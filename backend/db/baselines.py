"""The run that a launch is compared with: named, or the newest one with a label."""

from __future__ import annotations

from typing import NamedTuple

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import continuation, labels, snapshots
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Finding, Run, RunBaseline
from campaigns.asked.load import load_document
from campaigns.asked.problem import CampaignError
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.units import differing, fixed
from campaigns.labels import pair
from campaigns.results.baselines import CannotCompare, same_question, with_baseline
from campaigns.runs import ENDED, run_name, run_number

LABEL = "label:"
HOW = "give a run such as R-0001, or label:KEY=VALUE for the newest run of the same campaign with that label"
LONGEST = 300
"""Characters of a request for a baseline."""
LOOKED_AT = 500
"""Runs of the campaign with a label that are examined, the newest first."""


class Resolved(NamedTuple):
    campaign: Campaign
    run_id: int | None
    """None if no run has the label; the campaign has no baseline then."""
    sentence: str
    request: str = ""
    """What was asked for."""


def resolved(reader: sa.Connection, campaign: Campaign, request: str, here: Catalogue) -> Resolved:
    """The campaign with the baseline that was asked for; raises `CannotCompare` with a sentence if there is none.

    here: with the components of the campaign.

    A label that no run has is no error: the first run of a branch has no baseline, which the sentence states.
    """
    if request.startswith(LABEL):
        return _labelled(reader, campaign, request, here)
    run_id = run_number(request)
    if run_id is None:
        raise CannotCompare(f"invalid baseline {request[:60]!r}: {HOW}")
    other = _campaign(reader, run_id)
    return _compared(reader, campaign, run_id, other, f"Baseline: {run_name(run_id)}.", here)


def of_run(reader: sa.Connection, run_id: int) -> tuple[str, int | None] | None:
    """What a run was launched with: the request and the number of the baseline; None without one."""
    query = sa.select(RunBaseline.asked, RunBaseline.baseline).where(RunBaseline.run_id == run_id)
    row = reader.execute(query).one_or_none()
    return None if row is None else (row.asked, row.baseline)


def store(writer: sa.Connection, run_id: int, request: str, baseline: int | None) -> None:
    writer.execute(sa.insert(RunBaseline).values(run_id=run_id, asked=request[:LONGEST], baseline=baseline))


def none_found(request: str) -> str:
    return (
        f"No baseline: no run of this campaign that has ended with findings has the label "
        f"{request.removeprefix(LABEL)}. Nothing was compared; the verdict alone decides."
    )


def _labelled(reader: sa.Connection, campaign: Campaign, request: str, here: Catalogue) -> Resolved:
    try:
        wanted = pair(request.removeprefix(LABEL))
    except ValueError as error:
        raise CannotCompare(f"invalid baseline {request[:60]!r}: {error}") from None
    found = sa.exists().where(Finding.run_id == Run.id)
    # A variant of a sweep carries its labels and is of another value, which was not chosen to compare with.
    ended = (Run.state.in_(ENDED), Run.removed.is_(None), Run.purged.is_(None), found, ~in_sweep())
    named = Run.campaign_digest.in_(sa.select(CampaignRow.digest).where(CampaignRow.name == campaign.name))
    of = sa.select(Run.id).where(*ended, named, *labels.conditions([wanted]))
    query = of.order_by(Run.id.desc()).limit(LOOKED_AT)
    for run_id in reader.scalars(query).all():
        try:
            other = _campaign(reader, run_id)
            comparable = same_question(campaign, other) and not _other_units(reader, campaign, run_id, other, here)
        except CannotCompare:  # one of another version of Clearance
            continue
        if comparable:
            statement = f"Baseline: {run_name(run_id)}, the newest run with the label {'='.join(wanted)}."
            return _compared(reader, campaign, run_id, other, statement, here)
    return Resolved(campaign, None, none_found(request), request)


def _compared(
    reader: sa.Connection, campaign: Campaign, run_id: int, other: Campaign, statement: str, here: Catalogue
) -> Resolved:
    found, units = continuation.findings(reader, run_id), _other_units(reader, campaign, run_id, other, here)
    then = _components(reader, run_id)
    values = None if then is None else fixed(other, then)
    return Resolved(with_baseline(campaign, run_name(run_id), other, found, units, values), run_id, statement)


def _other_units(reader: sa.Connection, campaign: Campaign, run_id: int, other: Campaign, here: Catalogue) -> str:
    """How the units of a run differ, as a clause; runs of earlier versions may have stored none."""
    then = _components(reader, run_id)
    return "" if then is None else differing(other, then, campaign, here)


def _components(reader: sa.Connection, run_id: int) -> Catalogue | None:
    try:
        return snapshots.of_run(reader, run_id)
    except ValidationError:
        what = "the description of its components is of another version"
        raise CannotCompare(f"{run_name(run_id)} cannot be the baseline: {what}") from None


def _campaign(reader: sa.Connection, run_id: int) -> Campaign:
    name = run_name(run_id)
    state = continuation.state(reader, run_id)
    if state is None:
        raise CannotCompare(f"{name} cannot be the baseline: there is no such run")
    if reader.scalar(sa.select(Run.purged).where(Run.id == run_id)) is not None:
        raise CannotCompare(f"{name} cannot be the baseline: its results were permanently deleted")
    if continuation.is_removed(reader, run_id):
        raise CannotCompare(f"{name} cannot be the baseline: it was removed; restore it on its page, or give another")
    if state[0] not in ENDED:
        raise CannotCompare(
            f"{name} cannot be the baseline: it is {state[0]}; wait until it has ended, or give another"
        )
    try:
        return load_document(state[1], name)
    except CampaignError as error:
        raise CannotCompare(f"{name} cannot be the baseline: its campaign is of another version: {error}") from None
