"""Holds a campaign's criteria against the catalogue: which may decide, which need a goal that is a place.

Start reading at `criteria`.
"""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue


def criteria(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """One that is worse when low decides; none is given twice."""
    decides = catalogue.component("criterion", campaign.criterion.component)
    if decides is not None and decides.worse == "high":
        others = ", ".join(c.name for c in catalogue.components if c.role == "criterion" and c.worse == "low")
        text = f"this is worse when high and cannot decide; name one that is worse when low ({others}), this one "
        yield Problem("criterion.component", decides.name, f"{text}under objectives")
    if decides is not None and decides.of == "goal":
        yield from _reached("criterion.component", decides.name, campaign, catalogue)
    given = [(campaign.criterion.component, campaign.criterion.parameters)]
    for i, objective in enumerate(campaign.objectives):
        field = f"objectives.{i}.component"
        entry = catalogue.component("criterion", objective.component)
        if (objective.component, objective.parameters) in given:
            yield Problem(field, objective.component, "this criterion is given already; leave this out")
        elif entry is not None and entry.of == "goal":
            yield from _reached(field, entry.name, campaign, catalogue)
        given.append((objective.component, objective.parameters))


def _reached(field: str, name: str, campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    avoider = catalogue.component("avoider", campaign.scenario.avoider.component)
    if avoider is not None and not {"x", "y"} <= {g.name for g in avoider.goals}:
        text = f"it measures the way to the goal, and the goal of {avoider.name} is a course, no place; leave this out"
        yield Problem(field, name, text)
