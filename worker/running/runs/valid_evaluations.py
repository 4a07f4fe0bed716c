"""Evaluations of a run that other code began, as far as a new run may begin with them.

A stored evaluation is sound if what evaluates is the same to the digest; the evaluations of a stage are replayed if
what chooses its points is the same, too. From the first stage that is not, everything is evaluated. Read `valid`.
"""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.asked.spec import Campaign
from campaigns.identity.identity import Identity, identity_of, simulator_of, unsound
from campaigns.stages.found import declared
from campaigns.stored.records import Begun, Cited, Columns, StageRecord
from campaigns.versions import OtherCode
from worker.engine.stages.parts.store import Store
from worker.running.runs import identity
from worker.running.runs.losses import lost


def valid(store: Store, here: Identity, campaign: Campaign, records: Sequence[StageRecord]) -> dict[int, Columns]:
    """The sound evaluations of the run that this one continues, by the position of the stage; none without such a run.

    Raises `OtherCode` if other stages alone had found a violation or a failure: a worker that has their code replays
    them.
    """
    cited = store.cited()
    if cited is None or unsound(identity_of(cited.begun.versions, simulator_of(campaign)), here):
        return {}
    found = {position: cited.evaluations[position] for position in _replayed(cited, campaign, records)}
    others = [(cited.stages[at].plan, columns) for at, columns in cited.evaluations.items() if at not in found]
    others += [(cited.stages[at].plan, ahead.columns) for at, ahead in cited.ahead.items()]
    if why := lost(campaign.criterion.threshold, found.values(), others):
        raise OtherCode(f"of the run that it continues, {why}")
    return found


def _replayed(cited: Cited, campaign: Campaign, records: Sequence[StageRecord]) -> list[int]:
    """The positions of the stages that request the same points, until the first one that may not, or of which a part is
    stored."""
    found: list[int] = []
    for position, (before, record) in enumerate(zip(cited.stages, records, strict=False)):
        if before.plan != record.plan or not _same(cited.begun, record):
            break
        if position not in cited.evaluations or declared()[record.plan.kind].partly(campaign):
            break
        found.append(position)
    return found


def _same(begun: Begun, record: StageRecord) -> bool:
    """Whether the modules that choose the points of a stage were the same."""
    known = identity.loaded()
    wanted = identity.choosing(record.plan.kind, record.plan.method)
    return all(begun.modules.get(name) == known[name].digest for name in wanted)
