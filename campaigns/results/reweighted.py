"""An estimate from the independent sample of a run under other distributions than those that it was drawn from."""

from __future__ import annotations

from campaigns.results.base import Described, Result


class EstimatedQuantile(Result):
    """A value of the criterion that a fraction of the draws are at or below."""

    share: float
    value: float | None
    """Null where the effective number of draws below it is less than 10, and where it is among failed draws."""


class Reweighted(Described):
    """An estimate, never a bound, and no verdict rests on it: each stored draw counts by the ratio of the densities.

    Probability and interval are null and there are no quantiles where the estimate is refused; the sentence has the
    reason.
    """

    samples: int
    """Draws that were not excluded: the population of the estimate."""
    violations: int
    """Of these; failed ones count among them."""
    failed: int
    excluded: int
    effective: float
    """Kish's effective sample size: so many unweighted draws would estimate as well."""
    needed: int
    """The smallest effective sample size for an estimate."""
    outside: float
    """The probability of a draw outside the bounds, where nothing was evaluated, or an upper bound on it; included in
    the interval, relative to what is not excluded, and not in the probability."""
    confidence: float
    """Of the interval."""
    probability: float | None = None
    """P(violation) of draws within the bounds that are not excluded."""
    low: float | None = None
    high: float | None = None
    quantiles: list[EstimatedQuantile] = []
