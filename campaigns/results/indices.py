"""The result of the sensitivity stage: slices through the nominal point, Morris' and Sobol's indices."""

from __future__ import annotations

from typing import Literal

from campaigns.results.base import Described, Result
from campaigns.results.slices import Curve
from campaigns.results.stage import StageResult


class IndexStudy(Described):
    """Common to both kinds of index study; the sentence names the leading parameters, or why nothing was computed."""

    evaluations: int
    failed: int
    excluded: int
    confidence: float


class MorrisRow(Result):
    """Elementary effects of one parameter, per whole range, in the criterion's unit."""

    path: str
    mu: float | None
    mu_star: float | None
    mu_star_confidence: float | None
    sigma: float | None


class MorrisStudy(IndexStudy):
    """Morris 1991, with mu* of Campolongo et al. 2007."""

    trajectories: int
    levels: int
    indices: list[MorrisRow] | None
    """Null if they were not computed."""


class SobolRow(Result):
    """Fractions of the variance due to one parameter, with the half width of their interval."""

    path: str
    first: float | None
    first_confidence: float | None
    total: float | None
    total_confidence: float | None


class SobolStudy(IndexStudy):
    """Saltelli et al. 2010."""

    samples: int
    indices: list[SobolRow] | None
    """Null if they were not computed."""


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
