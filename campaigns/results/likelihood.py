"""How likely a case is under the stated distributions, and the most likely violation that was evaluated."""

from __future__ import annotations

from campaigns.results.base import Described, Result, Values
from campaigns.results.finding import Finding


class Likelihood(Described):
    """How likely a case is under the campaign's distributions, whatever the units and the number of parameters.

    All numbers are null where every point of the box is equally likely, where there is no highest density, and where
    correlated parameters are not normal, so that the highest one is not known.
    """

    density: float | None = None
    """The density as a fraction of the highest one."""
    distance: float | None = None
    """The same as a distance: sqrt(-2 ln density). Of normal distributions the distance from the mean in standard
    deviations, the reliability index of the point. Null where the density is zero."""
    tail: float | None = None
    """The probability that a draw is no more likely than this case; of normal distributions that it is at least as far
    from the mean."""
    parameters: int = 0
    """How many parameters count: all but uncorrelated uniform ones; 0 also where the density is unbounded."""


class LikelyFinding(Finding):
    """A finding with its likelihood, as files of a run state it; a service computes it when it is read."""

    likelihood: Likelihood


class LikelyViolation(Result):
    """A violation as evaluated by a stage; it was not validated."""

    position: int
    """Of its stage."""
    index: int
    """In its stage, counted from 0."""
    cost: float
    margin: float
    parameters: Values
    realisation: int | None = None
    """The noise seed drawn for its evaluation; null if it simulated the realisations of the campaign."""
    likelihood: Likelihood


class MostLikely(Described):
    """The most likely of the stored violations, which is not the most likely of all."""

    violations: int
    """Stored evaluations of all stages that violate the criterion; failed ones not included."""
    case: LikelyViolation | None = None
    """Null if none violates, and where likelihood does not distinguish them."""
