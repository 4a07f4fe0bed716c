"""The sensitivity stage: one parameter at a time over its bounds, and the indices if requested."""

from __future__ import annotations

from typing import Literal

from campaigns.asked.spec import Campaign
from campaigns.results.indices import IndexStudy, MorrisStudy, SobolStudy
from campaigns.results.slices import Curve
from campaigns.results.stage import StageResult
from campaigns.stages.declared import Declared


class SensitivityResult(StageResult):
    """One parameter at a time through the nominal point, and the indices if requested."""

    stage: Literal["sensitivity"] = "sensitivity"
    points: int
    curves: list[Curve]
    morris: MorrisStudy | None = None
    sobol: SobolStudy | None = None

    @property
    def slices(self) -> list[Curve]:
        return self.curves

    @property
    def studies(self) -> dict[str, IndexStudy]:
        return {name: study for name, study in (("Morris", self.morris), ("Sobol", self.sobol)) if study is not None}


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


stage = Declared("sensitivity", 1, "Sensitivity", SensitivityResult, _planned, _description, against=True)
