"""How fast obstacles turn, from what their components declare: what moves within a step is not seen by sampling.

`fastest` is the rate over intervals of an obstacle's parameters, `lasting` the time until a motion is over or repeats,
`ends` the instants at which its legs end;
`turning` gives the rate of every obstacle of a campaign over its bounds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import accumulate, pairwise
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
    top = _top(rate, values)
    if top == 0.0:
        return 0.0
    if rate.legs:  # at least the smallest number
        return math.pi * top / max(min(_lengths(rate, values), default=math.inf), 5e-324)
    least = (0.0 if low <= 0.0 <= high else min(abs(low), abs(high)) for low, high in (values[n] for n in rate.per))
    bottom = math.prod(least)
    return top / bottom if bottom else math.inf


def lasting(rate: RateEntry, values: Intervals) -> float:
    """How long a motion with exactly these values takes to its last corner, or for a whole turn [s]; 0 without either:
    it is straight, or there is none."""
    if rate.legs:
        top = _top(rate, values)
        return sum(_lengths(rate, values)) / top if top else 0.0
    highest = fastest(rate, values)
    return 2.0 * math.pi / highest if highest else 0.0


def ends(rate: RateEntry, values: Intervals) -> list[float]:
    """The instants at which the legs of a path with exactly these values end [s]; none of another motion."""
    top = _top(rate, values)
    return [length / top for length in accumulate(_lengths(rate, values))] if rate.legs and top else []


def corners(rate: RateEntry, values: Mapping[str, float]) -> list[tuple[float, ...]]:
    """The corners that a path of legs has with these values [m], in their order; none of another motion."""
    used = rate.legs[: _count(rate, values[rate.used] if rate.used else 0.0) + 1]
    return [tuple(values[f"{name}.{axis}"] for axis in "xyz" if f"{name}.{axis}" in values) for name in used]


def _count(rate: RateEntry, used: float) -> int:
    """How many legs are used; used: the value of the parameter that states it."""
    return int(used + 0.5) if rate.used else len(rate.legs)


def _top(rate: RateEntry, values: Intervals) -> float:
    return rate.times * math.prod(max(abs(low), abs(high)) for low, high in (values[name] for name in rate.of))


def _lengths(rate: RateEntry, values: Intervals) -> Iterator[float]:
    """The shortest length within these intervals of each leg that may have a length [m]."""
    count = _count(rate, values[rate.used][1] if rate.used else 0.0)
    for begin, end in list(pairwise(rate.legs))[:count]:
        ends = [(values[f"{begin}.{a}"], values[f"{end}.{a}"]) for a in "xyz" if f"{begin}.{a}" in values]
        if any(a != b or a[0] != a[1] for a, b in ends):
            yield math.hypot(*(max(0.0, b[0] - a[1], a[0] - b[1]) for a, b in ends))


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
            path = f"obstacles.{i}.{name}"
            values[name] = campaign.interval(path, known[path][1])
        yield Turning(i, entry.title, math.nan if entry.rate is None else fastest(entry.rate, values))
