"""The problems of a region of attraction: it needs a polynomial model of the closed loop about trim."""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue

FIELD = "stages.attraction"
MOST = {1: 6, 2: 6, 3: 6, 4: 4}
"""The degree of V by the number of states: a higher one takes hours."""


def attracted(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """A simulator, or a controller without a polynomial model."""
    if campaign.stages.attraction is None:
        return
    if campaign.simulator is not None:
        text = "a region of attraction is proved for a closed loop of components only; leave attraction out"
        yield Problem(FIELD, f"simulator {campaign.simulator.name}", text)
        return
    name = campaign.given_scenario.controller.component
    entry = catalogue.component("controller", name)
    if entry is not None and not entry.about_trim:
        known = " or ".join(c.name for c in catalogue.components if c.role == "controller" and c.about_trim)
        text = f"it declares no polynomial model about trim; use {known}, or leave attraction out"
        yield Problem(FIELD, f"controller {name}", text)
    elif entry is not None and (most := MOST.get(len(entry.about_trim), 0)) < (campaign.stages.attraction.degree or 2):
        text = f"a region of a loop with {len(entry.about_trim)} states is sought with a degree of at most {most}"
        yield Problem(f"{FIELD}.degree", f"{campaign.stages.attraction.degree or 2}", text)
