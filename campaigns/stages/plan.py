"""The stages of a run of a campaign, with the budget of each and the bound of the whole.

Worker and service both use it, so that their numbers agree. Every door states the one number that `most` gives (check,
launch, live page, client, command line, `clearance.search`), and the stages receive the same allowances.
"""

from __future__ import annotations

from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.limits import DRAWS, OTHERS
from campaigns.stages.found import StageKind, declared


class StagePlan(NamedTuple):
    """A stage before it starts; `planned` evaluations are its budget. For certify it excludes repeated draws."""

    kind: StageKind
    method: str | None
    planned: int


class Bounded(NamedTuple):
    """A stage: the evaluations that it stores at most, and those besides them, which no count of the run includes."""

    kind: StageKind
    method: str | None
    stored: int
    again: int

    @property
    def evaluations(self) -> int:
        """All of them."""
        return self.stored + self.again


def plan(campaign: Campaign) -> list[StagePlan]:
    """The stages of a run in their order."""
    return [
        StagePlan(stage.kind, method, evaluations)
        for stage in declared().values()
        for method, evaluations in stage.planned(campaign)
    ]


def left(kind: str, planned: int, evaluations: int, excluded: int) -> int:
    """How many evaluations a stage has left at this point, if it uses its whole budget; of a sample, whose excluded
    draws are drawn again, if as large a fraction of the others is excluded."""
    stage = declared().get(kind)
    if stage is None or not stage.redraws or not evaluations:
        return max(0, planned - evaluations)
    kept, most = evaluations - excluded, max(0, DRAWS * planned - evaluations)
    return min(most, -(-max(0, planned - kept) * evaluations // kept)) if kept > 0 else most


def bound(campaign: Campaign) -> list[Bounded]:
    """What each stage takes at most, in their order."""
    kinds = declared()
    found = [
        Bounded(s.kind, s.method, kinds[s.kind].most(campaign, s.planned), kinds[s.kind].again(campaign))
        for s in plan(campaign)
    ]
    return [s._replace(again=s.again + onward(found, campaign)) if kinds[s.kind].of_findings else s for s in found]


def onward(stages: list[Bounded], campaign: Campaign) -> int:
    """The evaluations of a closed loop besides the sample that are simulated on beyond the horizon, at most."""
    others = sum(s.stored for s in stages if not declared()[s.kind].independent)
    return 0 if campaign.scenario is None else min(OTHERS, others)


def most(campaign: Campaign) -> int:
    """The evaluations of a run, at most: stored ones and those made again."""
    return sum(stage.evaluations for stage in bound(campaign))
