"""The bound on P(violation) that the sample of a campaign can show at best, and whether that is enough.

Known before anything is evaluated. NumPy is imported late, because clients of a service start without it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from campaigns import rules
from campaigns.asked.distributions import Normal
from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue
from campaigns.checked import options
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
            f"{self.samples:,} random samples violates, fails or is excluded."
        )

    @property
    def _beyond(self) -> str:
        return f", of which {_most(self.outside)} is the probability beyond the bounds" if self.outside else ""

    def short_of(self, wanted: float) -> str:
        """Why the bound cannot be as low as wanted, and what to do, clauses; empty if it can."""
        from campaigns.results.remedies import needed

        if self.upper_bound <= wanted:
            return ""
        if self.outside >= wanted:
            why = (
                f"{_most(self.outside)} of the draws lie outside the bounds, which is part of the bound on P(violation)"
            )
            return f"{why}; widen the bounds"
        size = needed(0, 0, wanted - self.outside, self.confidence)
        more = "state a higher target" if size is None else f"draw {size:,} samples or more"
        wider = ", or widen the bounds" if self.outside else ""
        best = f"the best bound that {self.samples:,} samples can show is {_most(self.upper_bound)}{self._beyond}"
        return f"{best}; {more}{wider}"


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


def best(campaign: Campaign, catalogue: Catalogue, bounds: Bounds) -> Best | None:
    """The bound at best; None without a sample that is known to give one."""
    if campaign.stages.certify is not None:
        return _of("certify", campaign.stages.certify.samples, campaign, bounds)
    search = _independent(campaign, catalogue)
    return None if search is None else _of("search", search.evaluations, campaign, bounds)


def warning(found: Best, campaign: Campaign) -> str | None:
    """That what is required of the bound is out of reach, and what to do, a sentence; None if it is not."""
    required = rules.required(campaign.target_probability)
    why = found.short_of(required)
    if not why:
        return None
    what = "target P(violation)" if required == campaign.target_probability else "required bound on P(violation)"
    return f"The {what} of {_goal(required)} cannot be met: {why}."


def unattainable(campaign: Campaign, bounds: Bounds) -> list[Problem]:
    """The problem of a sample that ends by a target which it cannot meet, so that it would not even begin."""
    certify, target = campaign.stages.certify, campaign.target_probability
    if certify is None or certify.until != "target" or target is None:
        return []
    found = _of("certify", certify.samples, campaign, bounds)
    why = "" if found is None else found.short_of(target)
    text = f"the target P(violation) of {_goal(target)} cannot be met: {why}"
    return [Problem("stages.certify.samples", f"{certify.samples:,}", text)] if why else []


def _goal(probability: float) -> str:
    return written(probability, form=Format.PROBABILITY, digits=17)


def _of(source: Literal["certify", "search"], samples: int, campaign: Campaign, bounds: Bounds) -> Best | None:
    from campaigns.results.remedies import bound

    beyond = outside(campaign, bounds)
    if beyond is None:
        return None
    upper = min(1.0, bound(0, samples, campaign.confidence) + beyond)
    return Best(source, samples, campaign.confidence, beyond, upper)


def _independent(campaign: Campaign, catalogue: Catalogue) -> Search | None:
    """The random search that gives the bound: the first with its default options.

    None if an earlier one may end by its own rule, because its samples may give a bound too, of another number.
    """
    random = ((s, e) for s in campaign.stages.search if (e := catalogue.method(s.method)) and e.kind == "random")
    for search, entry in random:
        if not options.changed(search, entry, search.options):
            return search
        if options.changed(search, entry, entry.own_rule.split()):
            return None
    return None
