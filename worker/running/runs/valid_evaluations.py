"""Evaluations of a run that other code began, as far as a new run may begin with them.

A stored evaluation is sound if what evaluates is the same to the digest; the evaluations of a stage are replayed if
what chooses its points is the same, too. From the first stage that is not, everything is evaluated. Read `valid`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from campaigns.asked.spec import Campaign
from campaigns.identity.identity import Identity, identity_of, simulator_of, unsound
from campaigns.stages.found import declared
from campaigns.stored.records import Ahead, Begun, Cited, Columns, StageRecord
from campaigns.versions import OtherCode
from worker.engine.stages.parts.store import Store
from worker.running.runs import identity
from worker.running.runs.losses import lost, unstored


def valid(
    store: Store, here: Identity, campaign: Campaign, records: Sequence[StageRecord]
) -> dict[int, tuple[Columns, Ahead | None]]:
    """The sound evaluations of the run that this one continues, by the position of the stage, with those that an
    earlier one of the stage is missing for; none without such a run.

    Raises `OtherCode` if other stages alone saw what bars "cleared": a worker that has their code replays them.
    """
    cited = store.cited()
    if cited is None or unsound(identity_of(cited.begun.versions, simulator_of(campaign)), here):
        return {}
    same = _same_stages(cited, records)
    found = {at: cited.evaluations[at] for at in _replayed(cited, campaign, same)}
    # A closed loop evaluates the rest of these stages again to the same bits.
    made = {*found, *(range(same) if campaign.scenario is not None and store.sample_seed is not None else ())}
    parts = [*cited.evaluations.items(), *((at, ahead.columns) for at, ahead in cited.ahead.items() if at not in found)]
    others = [(cited.stages[at].plan, columns) for at, columns in parts if at not in made]
    again = [columns for at, columns in parts if at in made]
    sampled = all(at in made for at, record in enumerate(cited.stages) if declared()[record.plan.kind].independent)
    unseen = (unstored(campaign, s.result, again, sampled) for at, s in enumerate(cited.stages) if at not in made)
    if why := lost(campaign.criterion.threshold, again, others) or next(filter(None, unseen), ""):
        raise OtherCode(f"of the run that it continues, {why}")
    return {at: (columns, cited.ahead.get(at)) for at, columns in found.items()}


def _same_stages(cited: Cited, records: Sequence[StageRecord]) -> int:
    """How many of the first stages request the same points."""
    pairs = enumerate(zip(cited.stages, records, strict=False))
    others = (at for at, (old, new) in pairs if old.plan != new.plan or not _same(cited.begun, new))
    return next(others, min(len(cited.stages), len(records)))


def _replayed(cited: Cited, campaign: Campaign, same: int) -> Iterator[int]:
    """The positions of these stages until the first one of which nothing or only a part is stored."""
    for at, record in enumerate(cited.stages[:same]):
        if at not in cited.evaluations or declared()[record.plan.kind].partly(campaign):
            return
        yield at


def _same(begun: Begun, record: StageRecord) -> bool:
    """Whether the modules that choose the points of a stage were the same."""
    known = identity.loaded()
    wanted = identity.choosing(record.plan.kind, record.plan.method)
    return all(begun.modules.get(name) == known[name].digest for name in wanted)
