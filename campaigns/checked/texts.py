"""Formats numbers, limits and names in the checks of a campaign, and compares units."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from campaigns.catalogue import ParameterEntry


def within(value: float, low: float, high: float) -> bool:
    """Within the bounds, except for rounding: 10 % below 0.1 is 0.09000000000000001."""
    slack = 1e-9 * (high - low)
    return low - slack <= value <= high + slack


def number(value: float) -> str:
    return f"{value:.15g}"


def limits(entry: ParameterEntry) -> str:
    return f"{entry.text} must be within {entry.low:g} to {entry.high:g} {entry.unit}".rstrip()


def unit(text: str) -> str:
    return text.replace(" ", "").replace("*", "").replace("·", "").replace("²", "2").replace("^", "")


def known(name: str, names: Iterable[str]) -> str:
    names = list(names)
    close = difflib.get_close_matches(name, names, n=1)
    if close:
        return f"did you mean {close[0]!r}?"
    return (
        f"choose one of: {', '.join(names[:12])}{', ...' if len(names) > 12 else ''}"
        if names
        else "no name is valid here"
    )
