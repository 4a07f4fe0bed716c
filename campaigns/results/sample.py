"""The statement of an independent random sample and its seed, and of a full grid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Described, Result, Values

Noise = Literal["none", "drawn", "stated"]

KEPT, FAILURES, FIRST = 1000, 1000, 1024
"""What is stored of a counted sample: its lowest flights, the first without a result, and of its first draws all that
are not excluded, which are a sample as the whole is."""


class Histogram(Result):
    """Counts between consecutive edges."""

    edges: list[float]
    counts: list[int]


class QuantileBound(Described):
    """Wilks' lower bound on a quantile of the criterion."""

    share: float
    """The quantile."""
    order: int | None = None
    """Which of the lowest values it is."""
    bound: float | None = None
    """Null where the sample allows none."""
    needed: int | None = None
    """The smallest sample that allows one."""
    confidence: float | None = None


class Distribution(Result):
    """The empirical distribution function, and half the width of the band around it, which holds for the stated
    distributions within the bounds, without what is excluded."""

    values: list[float]
    """Distinct and ascending; those of earlier versions repeat equal ones."""
    shares: list[float]
    """The fraction of the sample at or below each value."""
    band: float
    """Where draws of correlated normal parameters beyond the bounds were redrawn, their probability is added; with
    excluded draws it is then 1."""


class Sample(Described):
    """Counts, moments and the bound on P(violation) of evaluations drawn from the campaign's distributions."""

    samples: int
    violations: int
    failed: int = 0
    """Counted among the violations."""
    excluded: int = 0
    """Draws without a result that are drawn again: of a closed loop those that start at or below the threshold, or
    that a criterion's own rule excludes; of a simulator those that it excludes, for its own reasons."""
    outside: float = 0.0
    """The probability beyond the bounds, or an upper bound on it; included in the bound."""
    confidence: float
    upper_bound: float | None
    """On P(violation), of draws that are not excluded; with a probability beyond the bounds of all draws, of which
    excluded ones count as no violations. Null for points that are not an independent sample."""
    excluded_fraction: float = 0.0
    """Of all draws."""
    noise: Noise = "stated"
    """Whether the evaluations simulated the noise realisations stated in the campaign, or drew one each."""
    lowest: float | None = None
    mean: float | None = None
    deviation: float | None = None
    histogram: Histogram | None = None
    looks: int | None = None
    """The number of interim analyses of a sample that may stop early; each spends a part of the error."""
    bound_samples: Annotated[int | None, UNLESS_NONE] = None
    """How many samples the bound counts, if not all: of a sample that ended early, those before its last block."""
    quantile: QuantileBound | None = None
    """Of a certify stage that did not end early."""
    distribution: Distribution | None = None
    """Of a certify stage that did not end early."""


Count = Annotated[int, Field(ge=0)]


class Beside(Result):
    """Evaluations of a stage that are counted and not stored."""

    evaluations: Count = 0
    failed: Count = 0
    timeouts: Count = 0
    """Among those that failed."""
    excluded: Count = 0
    violating: Count = 0
    """Those that failed not among them."""
    flaky: Count = 0
    """Succeeded only when a failed call was tried again."""
    exclusions: Mapping[str, Count] = {}
    """How many were excluded for each reason."""


class Blocks(Described):
    """The blocks of consecutive draws that a sample was flown in, from the first draw on: a list for each fact."""

    draws: list[Count]
    violations: list[Count]
    failed: list[Count]
    excluded: list[Count]
    lowest: list[float | None]
    digests: list[str]
    """Of the costs and status of each."""
    totals: list[float]
    """The sums of the costs above `low`."""
    squares: list[float]
    low: float
    """The histogram of all has bins of equal width from here on, an open one below and one above."""
    width: float
    places: list[Count]
    """The bins that are not empty, from the open one below on."""
    counts: list[Count]
    highest: float | None
    beside: Beside
    """What is not stored."""


class SoFar(Described):
    """A sample of which only the lowest are stored, while it is drawn: nothing is decided before it is whole."""

    samples: int
    violations: int
    upper_bound: float
    """On P(violation), if it ended now."""
    at_end: float
    """If none of the others violates."""
    failed: Count = 0
    """Of the violations, those that failed."""
    within_bounds: bool
    """Whether both hold only for draws within the bounds: what is beyond them is not known here."""


class GridPoint(Result):
    """An evaluation of the grid."""

    cost: float
    margin: float
    parameters: Values


class GridResult(Described):
    """A full grid; nothing is claimed between its points."""

    points: int
    """On every axis."""
    total: int
    spacing: Values
    lowest: GridPoint | None
    violations: int
    failed: int
    excluded: int


class Certificate(Described):
    """The independent sample that supports a claim on probability, and where it came from."""

    sample: Sample
    seed: int | None = None
    """From which its points and noise follow; null in results of earlier versions: the campaign's."""
    drawn_at_launch: bool = False
    """Whether the seed was drawn when the run was launched, so that no user has chosen it."""
