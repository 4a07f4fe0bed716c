"""The sensitivity stage: one parameter at a time over its bounds, and the indices if requested."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.sensitivity import SensitivityResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    # Curves, Morris' trajectories of dimension + 1 evaluations, Saltelli's design without second orders.
    sensitivity, dimension = campaign.stages.sensitivity, len(campaign.uncertain)
    if sensitivity is None:
        return []
    morris = 0 if sensitivity.morris is None else sensitivity.morris.trajectories * (dimension + 1)
    sobol = 0 if sensitivity.sobol is None else sensitivity.sobol.samples * (dimension + 2)
    return [(None, sensitivity.points * dimension + morris + sobol)]


def _description(campaign: Campaign) -> str:
    number = len(campaign.uncertain)
    return f"{number} {'parameter' if number == 1 else 'parameters'}, one at a time"


stage = Declared("sensitivity", 1, "Sensitivity", SensitivityResult, _planned, _description)
