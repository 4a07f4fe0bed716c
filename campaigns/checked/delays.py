"""Refuses delays of guidance whose sum is longer than earlier demands are stored: the limit of one holds for all."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Part
from campaigns.catalogue import ComponentEntry
from campaigns.checked.orders import SLACK, Interval
from campaigns.checked.texts import number

PERIODS = "periods"
"""The parameter with a delay in guidance periods."""


def excessive(
    found: Iterable[tuple[str, str, ComponentEntry, Part]], bounds: Mapping[str, Interval]
) -> Iterator[Problem]:
    """Delays that are too long in sum at their upper bounds; found and bounds as for `orders.broken`."""
    late = {
        f"{prefix}.{PERIODS}": p.high
        for prefix, _, entry, _ in found
        if entry.path == "guidance"
        for p in entry.parameters
        if p.name == PERIODS
    }
    total, most = math.fsum(bounds[path][1] for path in late), min(late.values(), default=math.inf)
    if len(late) > 1 and total > most * (1 + SLACK):
        delays_text = ", ".join(f"{path} {number(bounds[path][1])}" for path in late)
        text = f"delays of guidance add up, to at most {most:g} periods: give smaller ones, or remove one"
        yield Problem("scenario.faults", delays_text, text)
