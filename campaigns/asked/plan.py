"""The stages of a run, and the number of evaluations planned for each.

Used by the runner and by the service, so that both agree.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Sensitivity

StageKind = Literal["nominal", "sensitivity", "search", "certify", "validate"]


class Planned(NamedTuple):
    """One stage to come; `planned` evaluations are its budget. For validate they are an estimate, because the
    number of worst cases is not known in advance.

    For certify it is the number without exclusions; excluded draws are additional.
    The step-halving check and the reference integrator check an evaluation and do not count as evaluations.
    """

    kind: StageKind
    method: str | None
    planned: int


def plan(campaign: Campaign) -> list[Planned]:
    """The stages of a run in their order."""
    stages = [Planned("nominal", None, 1)]
    dimension, certify = len(campaign.uncertain), campaign.stages.certify
    if campaign.stages.sensitivity is not None:
        stages.append(Planned("sensitivity", None, _studied(campaign.stages.sensitivity, dimension)))
    stages.extend(Planned("search", search.method, search.evaluations) for search in campaign.stages.search)
    if certify is not None:
        grid = 0 if certify.grid is None else certify.grid.points**dimension
        stages.append(Planned("certify", None, certify.samples + grid))
    stages.append(Planned("validate", None, _validating(campaign)))
    return stages


def _studied(asked: Sensitivity, dimension: int) -> int:
    """Curves, Morris' trajectories of dimension + 1 evaluations, Saltelli's design without second orders."""
    morris = 0 if asked.morris is None else asked.morris.trajectories * (dimension + 1)
    sobol = 0 if asked.sobol is None else asked.sobol.samples * (dimension + 2)
    return asked.points * dimension + morris + sobol


def _validating(campaign: Campaign) -> int:
    """The usual evaluations for distinguishing the worst cases (measured on the library), and the neighbours of one."""
    usual = 400 * (len(campaign.uncertain) + 1)
    return min(campaign.stages.findings.evaluations, usual) + campaign.stages.validate_.neighbours
