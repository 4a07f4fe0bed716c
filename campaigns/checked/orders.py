"""Validates the values of a component against each other: crossed limits, and what no physics allows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Part
from campaigns.catalogue import ComponentEntry, OrderEntry
from campaigns.checked.texts import number

Interval = tuple[float, float]

SLACK = 1e-9
"""Both sides count as equal within this fraction: 18 times 0.1 is below a tenth of 18 only by rounding."""


def broken(found: Iterable[tuple[str, str, ComponentEntry, Part]], bounds: Mapping[str, Interval]) -> Iterator[Problem]:
    """The orders that do not hold for all values within the bounds by path; found: as `check.installed` gives it.

    The corners of the bounds are enough, because both sides are products.
    """
    for prefix, field, entry, _ in found:
        for order in entry.orders:
            values = {name: bounds[f"{prefix}.{name}"] for name in (*order.low, *order.high)}
            # a required value that is missing is reported elsewhere
            if any(math.isnan(end) for ends in values.values() for end in ends) or _holds(order, values):
                continue
            ranges_text = ", ".join(f"{name} {_written(*ends)}" for name, ends in values.items())
            yield Problem(f"{field}.parameters", ranges_text, f"{order} must hold for all values: {order.text}")


def _holds(order: OrderEntry, values: dict[str, Interval]) -> bool:
    most = max(_corners(order.low, values))
    least = order.times * min(_corners(order.high, values))
    return order.equal if math.isclose(most, least, rel_tol=SLACK) else most < least


def _corners(names: list[str], values: dict[str, Interval]) -> list[float]:
    return [math.prod(corner) for corner in itertools.product(*(values[name] for name in names))]


def _written(low: float, high: float) -> str:
    return number(low) if low == high else f"{number(low)} to {number(high)}"
