"""Checks that components which depend on up, right or heading assume the axes of the vehicle."""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue, ComponentEntry

AXES = {"enu": "x east, y north, z up", "ned": "x north, y east, z down"}


def mismatched(campaign: Campaign, catalogue: Catalogue, parts: list[tuple[str, ComponentEntry]]) -> Iterator[Problem]:
    """Refuses components that are written for other axes than the vehicle's; parts: field and entry."""
    vehicle = catalogue.component("vehicle", campaign.given_scenario.vehicle.component)
    if vehicle is None:
        return
    for field, entry in parts:
        if entry.written_in in ("", vehicle.frame):
            continue
        fits = [
            c.name
            for c in catalogue.components
            if c.role == entry.role and c.written_in in ("", vehicle.frame) and c.dimension in (None, vehicle.dimension)
        ]
        use = f"; the same in all axes or written for these: {', '.join(fits)}" if fits else ""
        yield Problem(
            f"{field}.component",
            entry.name,
            f"it is written for axes {AXES[entry.written_in]}; the vehicle {vehicle.name} has {AXES[vehicle.frame]}: "
            f"up, right and headings would be misinterpreted{use}",
        )
