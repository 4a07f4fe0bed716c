"""A campaign's criteria: their names in results, and their validation against the catalogue."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue, ComponentEntry, ResultEntry


def criteria(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """The deciding criterion must be worse when low; none may be given twice."""
    decides = catalogue.component("criterion", campaign.criterion.component)
    if decides is not None and decides.worse == "high":
        others = ", ".join(c.name for c in catalogue.components if c.role == "criterion" and c.worse == "low")
        text = f"this is worse when high and cannot decide; name one that is worse when low ({others}), this one "
        yield Problem("criterion.component", decides.name, f"{text}under objectives")
    if decides is not None and decides.of == "goal":
        yield from _reached("criterion.component", decides.name, campaign, catalogue)
    measures = [(campaign.criterion.component, campaign.criterion.parameters)]
    for i, objective in enumerate(campaign.objectives):
        field = f"objectives.{i}.component"
        entry = catalogue.component("criterion", objective.component)
        if (objective.component, objective.parameters) in measures:
            yield Problem(field, objective.component, "this criterion is already given; remove this entry")
        elif entry is not None and entry.of == "goal":
            yield from _reached(field, entry.name, campaign, catalogue)
        measures.append((objective.component, objective.parameters))


def deciding(campaign: Campaign, catalogue: Catalogue) -> ComponentEntry | ResultEntry | None:
    """What decides the verdict: a criterion, or a result of the simulator; None if the catalogue has none."""
    if campaign.simulator is None:
        return catalogue.component("criterion", campaign.criterion.component)
    simulator = catalogue.simulator(campaign.simulator.name)
    return None if simulator is None else simulator.result(campaign.criterion.result)


def named(components: Iterable[str]) -> list[str]:
    """Unique names of the criteria in results: a second criterion of the same component is name#2."""
    found: list[str] = []
    for component in components:
        alike = sum(name.partition("#")[0] == component for name in found)
        found.append(f"{component}#{alike + 1}" if alike else component)
    return found


def _reached(field: str, name: str, campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    avoider = catalogue.component("avoider", campaign.given_scenario.avoider.component)
    if avoider is not None and not {"x", "y"} <= {g.name for g in avoider.goals}:
        text = (
            f"this criterion measures the distance to the goal, but {avoider.name} follows a path and has no goal "
            "position; remove this entry"
        )
        yield Problem(field, name, text)
