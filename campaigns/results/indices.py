"""Studies of the influence of the parameters on the whole region: Morris' and Sobol's indices."""

from __future__ import annotations

from campaigns.results.base import Described, Result


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
    """Fractions of the variance due to one parameter, with the half width of their interval, null where too few
    evaluations decide them."""

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
