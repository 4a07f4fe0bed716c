"""The bound on P(violation) that the sample of a campaign can show at best, and whether that is enough.

Known before anything is evaluated. NumPy is imported late, because clients of a service start without it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from campaigns.asked.distributions import Normal
from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.claims.numbers import Format, written

Bounds = Mapping[str, tuple[float, float]]
"""Low and high by path, in the parameters' units."""


class Best(NamedTuple):
    """The bound on P(violation) if no sample violates, fails or is excluded.

    source: the stage that draws the samples; outside: the probability of draws outside the bounds, part of the bound.
    """

    source: Literal["certify", "search"]
    samples: int
    confidence: float
    outside: float
    upper_bound: float

    @property
    def statement(self) -> str:
        """The bound and its condition, a sentence."""
        sure = written(self.confidence, form=Format.AT_LEAST)
        beyond = f"{self._beyond}," if self.outside else ""
        return (
            f"P(violation) is at most {_most(self.upper_bound)} with {sure} confidence{beyond} if none of the "
            f"{_samples(self.samples, 'random sample')} violates, fails or is excluded."
        )

    @property
    def _beyond(self) -> str:
        return f", of which {_most(self.outside)} is the probability beyond the bounds" if self.outside else ""

    def short_of(self, wanted: float) -> str:
        """Why the bound cannot be as low as wanted, and what to do, clauses; empty if it can."""
        from campaigns.asked.sample_bound import needed

        if self.upper_bound <= wanted:
            return ""
        if self.outside >= wanted:
            why = (
                f"{_most(self.outside)} of the draws lie outside the bounds, which is part of the bound on P(violation)"
            )
            return f"{why}; widen the bounds"
        size = needed(0, 0, wanted - self.outside, self.confidence)
        more = "state a higher target" if size is None else f"draw {_samples(size)} or more"
        wider = ", or widen the bounds" if self.outside else ""
        best = f"the best bound that {_samples(self.samples)} can show is {_most(self.upper_bound)}{self._beyond}"
        return f"{best}; {more}{wider}"


def _samples(number: int, noun: str = "sample") -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _most(probability: float) -> str:
    return written(probability, form=Format.AT_MOST, digits=3)


def tailed(campaign: Campaign) -> bool:
    """Whether draws may lie outside the bounds."""
    return any(isinstance(one.distribution, Normal) for one in campaign.uncertain.values())


def outside(campaign: Campaign, bounds: Bounds) -> float | None:
    """The probability of draws outside these bounds; None if a parameter has none here."""
    if not tailed(campaign):
        return 0.0
    from campaigns.densities.joint import joint

    return joint(campaign, bounds).outside if bounds.keys() >= campaign.uncertain.keys() else None


def unattainable(campaign: Campaign, bounds: Bounds) -> list[Problem]:
    """The problem of a sample that ends by a target which it cannot meet, so that it would not even begin."""
    certify, target = campaign.stages.certify, campaign.target_probability
    if certify is None or certify.until != "target" or target is None:
        return []
    found = best_of("certify", certify.samples, campaign, bounds)
    why = "" if found is None else found.short_of(target)
    text = f"the target P(violation) of {goal(target)} cannot be met: {why}"
    return [Problem("stages.certify.samples", f"{certify.samples:,}", text)] if why else []


def goal(probability: float) -> str:
    """A probability that a bound is compared with, in words."""
    return written(probability, form=Format.PROBABILITY, digits=17)


def best_of(source: Literal["certify", "search"], samples: int, campaign: Campaign, bounds: Bounds) -> Best | None:
    """The bound of so many samples; None if what is outside the bounds is not known."""
    from campaigns.asked.sample_bound import bound

    beyond = outside(campaign, bounds)
    if beyond is None:
        return None
    upper = min(1.0, bound(0, samples, campaign.confidence) + beyond)
    return Best(source, samples, campaign.confidence, beyond, upper)
