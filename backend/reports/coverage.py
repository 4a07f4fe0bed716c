"""How much of the box the evaluations cover, as rows of a report."""

from __future__ import annotations

from markupsafe import Markup

from backend.reports.record import Record
from campaigns.claims import numbers

LEAST = 5
"""Number of least covered pairs that are listed."""


def pairs(record: Record) -> list[tuple[Markup, Markup, int]]:
    """The least covered pairs of parameters, and how many of their bins have an evaluation; none if all have one."""
    least = [pair for pair in record.coverage.pairs[:LEAST] if pair.touched < record.coverage.bins]
    return [(record.symbol_html(pair.first), record.symbol_html(pair.second), pair.touched) for pair in least]


def centre(record: Record) -> list[tuple[Markup, str, str]]:
    """The centre of the empty ball: symbol, value and unit of each parameter."""
    at = {} if record.coverage.ball is None else record.coverage.ball.centre
    entries = [(path, value, record.entry(path)) for path, value in at.items()]
    return [
        (record.symbol_html(path), numbers.plain(value), numbers.unit_in_print(entry.unit) if entry else "")
        for path, value, entry in entries
    ]
