"""Compares obstacle sizes with the threshold: a distance to a centre does not show whether a vehicle is inside."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue, ComponentEntry, ParameterEntry, ReachEntry
from campaigns.checked.texts import number

Known = Mapping[str, tuple[ParameterEntry, float]]

SLACK = 1e-9
"""A threshold counts as equal to a reach within this fraction of it: half of a root is rarely exact."""


def centres(campaign: Campaign, catalogue: Catalogue, known: Known) -> Iterator[Problem]:
    """Refuses thresholds with which a vehicle inside an obstacle would satisfy the criterion."""
    criterion, entry = campaign.criterion, catalogue.component("criterion", campaign.criterion.component)
    measured_to = "" if entry is None else entry.measured_to
    if criterion.from_centre and measured_to != "centre":
        text = f"{criterion.component} does not measure to obstacles' centres; remove this"
        yield Problem("criterion.from_centre", "true", text)
    if measured_to == "surface" and criterion.threshold < 0:
        text = "below 0 a vehicle inside an obstacle would count as clear; give 0 or more"
        yield Problem("criterion.threshold", number(criterion.threshold), text)
    inside = within(campaign, catalogue, known) if entry is not None and in_metres(entry) else {}
    if measured_to == "centre" and inside and not criterion.from_centre:
        yield Problem("criterion.threshold", number(criterion.threshold), _sentence(catalogue, inside))


def in_metres(criterion: ComponentEntry) -> bool:
    """Whether its threshold can be compared with lengths; a catalogue of an earlier version may state no unit."""
    return criterion.unit == "m" or "unit" not in criterion.model_fields_set


def within(campaign: Campaign, catalogue: Catalogue, known: Known) -> dict[str, float]:
    """The obstacles by path whose largest reach is above the threshold, with that reach [m]."""
    threshold = campaign.criterion.threshold
    found = {}
    for i, obstacle in enumerate(campaign.given_scenario.obstacles):
        entry = catalogue.component("obstacle", obstacle.component)
        if entry is None or entry.reach is None:
            continue
        reach = largest(entry.reach, f"obstacles.{i}", campaign, known)
        if threshold < reach * (1 - SLACK):
            found[f"obstacles.{i}"] = reach
    return found


def unknown(campaign: Campaign, catalogue: Catalogue) -> list[tuple[int, str]]:
    """The obstacles whose extent is not declared: number from 0, and title."""
    found = []
    for i, obstacle in enumerate(campaign.given_scenario.obstacles):
        entry = catalogue.component("obstacle", obstacle.component)
        # A catalogue stored by an earlier version may not know reaches.
        if entry is not None and entry.reach is None and "reach" in entry.model_fields_set:
            found.append((i, entry.title))
    return found


def largest(reach: ReachEntry, prefix: str, campaign: Campaign, known: Known) -> float:
    """The reach of an obstacle [m]; for an uncertain parameter, with the bound of larger magnitude."""
    return reach.times * math.hypot(*(_largest(f"{prefix}.{name}", campaign, known) for name in reach.of))


def _largest(path: str, campaign: Campaign, known: Known) -> float:
    if path not in known:
        return 0.0
    nominal = known[path][1]
    uncertain = campaign.uncertain.get(path)
    if uncertain is None:
        return abs(nominal)
    if uncertain.plus_minus is not None and not math.isfinite(nominal):
        return math.nan
    return max(map(abs, uncertain.interval(nominal)))


def _sentence(catalogue: Catalogue, inside: Mapping[str, float]) -> str:
    path = max(inside, key=lambda p: inside[p])
    others = f" and {len(inside) - 1} more" if len(inside) > 1 else ""
    surface = [c.name for c in catalogue.components if c.role == "criterion" and c.measured_to == "surface"]
    use = f"use {' or '.join(surface)} (distance to the surface)" if surface else "measure to the surface"
    reach = _upward(inside[path])
    return (
        f"this distance is measured to the obstacles' centres, and the surface of {path}{others} extends to {reach} m "
        f"from its centre: a vehicle inside it would count as clear; {use}, give at least {reach} m, "
        f"or state from_centre: true if distances to the centre are meant"
    )


def _upward(reach: float) -> str:
    """The reach rounded up to at most 6 digits, so that it is accepted as a threshold."""
    text = f"{reach:.6g}"
    below = float(text) < reach * (1 - SLACK)
    return f"{reach + 10.0 ** (math.floor(math.log10(reach)) - 5):.6g}" if below else text
