"""Validates the values of parameters in a campaign against their entries in the catalogue."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from campaigns.asked.problem import Problem
from campaigns.catalogue import ParameterEntry
from campaigns.checked import texts


def refused(field: str, entries: list[ParameterEntry], values: Mapping[str, float]) -> Iterator[Problem]:
    """Unknown names, values beyond a parameter's own limits, and missing required values."""
    known = {e.name: e for e in entries}
    for name, value in values.items():
        if name not in known:
            yield Problem(f"{field}.{name}", texts.number(value), f"no such parameter; {texts.known(name, known)}")
        elif not known[name].low <= value <= known[name].high:
            yield Problem(f"{field}.{name}", texts.number(value), texts.limits(known[name]))
    for name, entry in known.items():
        if entry.default is None and name not in values:
            yield Problem(f"{field}.{name}", "", f"this parameter is required: {entry.text} [{entry.unit}]")


def valued(
    prefix: str, entries: list[ParameterEntry], values: Mapping[str, float]
) -> dict[str, tuple[ParameterEntry, float]]:
    """Every parameter by path, with its entry and nominal value: NaN if it is required but missing."""
    missing = float("nan")
    return {f"{prefix}.{e.name}": (e, values.get(e.name, missing if e.default is None else e.default)) for e in entries}
