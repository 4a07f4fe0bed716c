"""The stages a run of a campaign goes through, and how many evaluations each may fly.

The runner plans with it and the service announces with it, so that both count alike. Start reading at `plan`.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from campaigns.spec import Campaign

StageKind = Literal["nominal", "sensitivity", "search", "certify", "validate"]


class Planned(NamedTuple):
    """One stage to come; `planned` evaluations are its budget. Of validate it is what telling the findings apart and
    their neighbours may take at most, seldom what they take.

    Flights at half the step and with the other integrator are checks of an evaluation, not evaluations.
    """

    kind: StageKind
    method: str | None
    planned: int


def plan(campaign: Campaign) -> list[Planned]:
    """The stages of a run in their order."""
    stages = [Planned("nominal", None, 1)]
    sensitivity = campaign.stages.sensitivity
    if sensitivity is not None:
        stages.append(Planned("sensitivity", None, sensitivity.points * len(campaign.uncertain)))
    stages.extend(Planned("search", search.method, search.evaluations) for search in campaign.stages.search)
    findings, neighbours = campaign.stages.findings, campaign.stages.validate_.neighbours
    stages.append(Planned("validate", None, findings.evaluations + findings.at_most * neighbours))
    return stages
