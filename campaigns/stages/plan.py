"""The stages that a run of a campaign goes through, and how many evaluations each may take.

The worker plans with it and the service announces with it, so that both count alike. Start reading at `plan`.
"""

from __future__ import annotations

from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.stages.found import StageKind, declared


class Planned(NamedTuple):
    """One stage to come; `planned` evaluations are its budget.

    Of validate they are an estimate: the number of worst cases is not known before. Of certify they are what is
    simulated where nothing is excluded. Checks at half the step and with the reference integrator are not counted.
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
