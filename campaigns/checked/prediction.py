"""The bound on P(violation) that a run can show at best, and a warning where less is required."""

from __future__ import annotations

from campaigns import rules
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue
from campaigns.checked import options
from campaigns.checked.best_bound import Best, best_of, goal
from campaigns.checked.check import ranges


def predicted(campaign: Campaign, catalogue: Catalogue) -> Best | None:
    """The bound of a run at best; None without a sample that is known to give one."""
    bounds = ranges(campaign, catalogue)
    if campaign.stages.certify is not None:
        return best_of("certify", campaign.stages.certify.samples, campaign, bounds)
    search = _independent(campaign, catalogue)
    return None if search is None else best_of("search", search.evaluations, campaign, bounds)


def warning(found: Best, campaign: Campaign) -> str | None:
    """That what is required of the bound is out of reach, and what to do, a sentence; None if it is not."""
    required = rules.required(campaign.target_probability)
    why = found.short_of(required)
    if not why:
        return None
    what = "target P(violation)" if required == campaign.target_probability else "required bound on P(violation)"
    return f"The {what} of {goal(required)} cannot be met: {why}."


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
