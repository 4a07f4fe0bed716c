"""The stages of a run of a campaign, with the budget of evaluations of each.

Worker and service both use it, so that their numbers agree.
"""

from __future__ import annotations

from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.stages.found import StageKind, declared


class Planned(NamedTuple):
    """One planned stage; `planned` evaluations are its budget.

    For validate this is an estimate, since the number of worst cases is not known in advance. For certify it excludes
    repeated draws. Checks at half the step and with the reference integrator are not counted.
    """

    kind: StageKind
    method: str | None
    planned: int


def plan(campaign: Campaign) -> list[Planned]:
    """The stages of a run in their order."""
    return [
        Planned(stage.kind, method, evaluations)
        for stage in declared().values()
        for method, evaluations in stage.planned(campaign)
    ]
