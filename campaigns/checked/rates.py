"""How fast obstacles turn, from what their components declare: what moves within a step is not seen by sampling.

`fastest` is the rate over intervals of an obstacle's parameters; `turning` gives that of every obstacle of a campaign
over its bounds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple

from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue, ParameterEntry, RateEntry

Intervals = Mapping[str, tuple[float, float]]
"""The lowest and the highest value of an obstacle's parameters, by name."""


class Turning(NamedTuple):
    """An obstacle that moves by itself: its number from 0, title and rate [rad/s], NaN if it declares none."""

    number: int
    title: str
    rate: float


def fastest(rate: RateEntry, values: Intervals) -> float:
    """The highest rate for any values within these intervals [rad/s]; infinite if there is no highest."""
    top = rate.times * math.prod(max(abs(low), abs(high)) for low, high in (values[name] for name in rate.of))
    if top == 0.0:
        return 0.0
    if rate.legs:
        return math.pi * top / _shortest(rate, values)
    least = (0.0 if low <= 0.0 <= high else min(abs(low), abs(high)) for low, high in (values[n] for n in rate.per))
    bottom = math.prod(least)
    return top / bottom if bottom else math.inf


def _shortest(rate: RateEntry, values: Intervals) -> float:
    """The shortest leg of any path within these intervals [m], at least the smallest number; legs that never have a
    length do not count."""
    count = int(values[rate.used][1] + 0.5) if rate.used else len(rate.legs)
    legs = []
    for begin, end in list(pairwise(rate.legs))[:count]:
        ends = [(values[f"{begin}.{a}"], values[f"{end}.{a}"]) for a in "xyz" if f"{begin}.{a}" in values]
        if any(a != b or a[0] != a[1] for a, b in ends):
            legs.append(math.hypot(*(max(0.0, b[0] - a[1], a[0] - b[1]) for a, b in ends)))
    return max(min(legs, default=math.inf), 5e-324)


def turning(
    campaign: Campaign, catalogue: Catalogue, known: Mapping[str, tuple[ParameterEntry, float]]
) -> Iterator[Turning]:
    """Every obstacle that moves by itself, with its highest rate for any values within the bounds."""
    for i, obstacle in enumerate(campaign.given_scenario.obstacles):
        entry = catalogue.component("obstacle", obstacle.component)
        # A catalogue stored by an earlier version does not know rates.
        if entry is None or not entry.moving or "rate" not in entry.model_fields_set:
            continue
        values = {}
        for name in (p.name for p in entry.parameters):
            nominal = known[path := f"obstacles.{i}.{name}"][1]
            uncertain = campaign.uncertain.get(path)
            values[name] = (nominal, nominal) if uncertain is None else uncertain.interval(nominal)
        yield Turning(i, entry.title, math.nan if entry.rate is None else fastest(entry.rate, values))
