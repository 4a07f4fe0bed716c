"""The stages a run of a campaign goes through, and how many evaluations each may fly.

The runner plans with it and the service announces with it, so that both count alike. Start reading at `plan`.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from campaigns.spec import Campaign

StageKind = Literal["nominal", "sensitivity", "search", "certify", "validate"]

FLIGHTS_PER_CASE = 2
"""A validated case is flown at the step and at half the step; the other integrator's flight is no evaluation."""


class Planned(NamedTuple):
    """One stage to come; `planned` evaluations are its budget or, for validate, an estimate with one finding."""

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
    cases = 2  # the nominal flight and the worst finding
    stages.append(Planned("validate", None, cases * FLIGHTS_PER_CASE + campaign.stages.validate_.neighbours))
    return stages
