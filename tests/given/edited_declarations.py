"""Declarations of a simulator of which one field was edited."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel

from campaigns.catalogue import SimulatorEntry
from tests.simulators import two_basins

ENTRY = two_basins.ENTRY
WORDS = {
    "title", "text", "parameters.symbol", "parameters.text", "results.title", "results.quantity", "results.text",
}  # fmt: skip
"""The fields that are for readers only."""


def _edited(entry: BaseModel, field: str) -> object:
    value = getattr(entry, field)
    if field == "worse":
        return {"low": "high", "high": "low"}[value]
    if isinstance(value, float):
        return value + 0.125
    if isinstance(value, dict):
        return value | {"x": "2"}
    return "x" if value is None else f"{value}2"


def _edits() -> Iterator[tuple[str, SimulatorEntry]]:
    for field in SimulatorEntry.model_fields:
        parts = getattr(ENTRY, field)
        if isinstance(parts, list):
            yield f"{field}, one less", ENTRY.model_copy(update={field: parts[:-1]})
            for inner in type(parts[0]).model_fields:
                first = parts[0].model_copy(update={inner: _edited(parts[0], inner)})
                yield f"{field}.{inner}", ENTRY.model_copy(update={field: [first, *parts[1:]]})
        elif field != "name":
            yield field, ENTRY.model_copy(update={field: _edited(ENTRY, field)})


EDITS = dict(_edits())
