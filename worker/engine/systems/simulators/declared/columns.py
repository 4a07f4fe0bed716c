"""The columns of a trace, as a decorated function or an FMU declares them. Only the standard library is imported."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields

TIME = "time"
MOST = 64
"""Columns of a trace."""
NAME = re.compile(r"[a-z][a-z0-9_]{0,59}", re.ASCII)


@dataclass(frozen=True)
class Column:
    """A quantity over time that a simulator returns with a trace: its unit, one line of text, its symbol."""

    unit: str = ""
    text: str = ""
    symbol: str = ""


def columns(declared: object) -> dict[str, Column]:
    """Columns by name, `time` [s] among them, each a `Column` or a dict of its fields.

    Raises ValueError or TypeError with a sentence for the first that cannot be used.
    """
    if not isinstance(declared, Mapping):
        raise TypeError(f"trace must be a dict of columns by name, given {declared!r:.60}")
    found = {name: _column(name, column) for name, column in declared.items()}
    if TIME not in found or not 2 <= len(found) <= MOST:
        named = ", ".join(map(str, list(found)[:8])) or "nothing"
        raise ValueError(f"trace: the column time and 1 to {MOST - 1} others are expected, given {named}")
    if found[TIME].unit not in ("", "s"):
        raise ValueError(f"trace: time is in s, given the unit {found[TIME].unit}")
    return found


def _column(name: object, declared: object) -> Column:
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise ValueError(f"trace: invalid name {name!r:.60}: give small letters, digits and _, such as height")
    known = [field.name for field in fields(Column)]
    if isinstance(declared, Mapping):
        unknown = [key for key in declared if key not in known]
        if unknown:
            raise ValueError(f"trace: {name} has no {unknown[0]!r:.60}; give {', '.join(known)}")
        declared = Column(**declared)
    if not isinstance(declared, Column):
        raise TypeError(f"trace: {name} must be a dict such as {{'unit': 'm'}}, given {declared!r:.60}")
    for key in known:
        if not isinstance(getattr(declared, key), str):
            raise TypeError(f"trace: {name}: {key} must be a text, given {getattr(declared, key)!r:.60}")
    return declared
