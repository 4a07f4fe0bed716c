"""The run that another one extends, as result.json and the report state it."""

from __future__ import annotations

from typing import TypedDict

Cited = TypedDict("Cited", {"as": str, "run": str, "digest": str, "code": None}, total=False)
"""The run that is extended, and the number of the new one in the database; code: its version was not stored."""


def named(cites: Cited) -> str:
    """The run that is extended, with its campaign where that is known."""
    return f"{cites['run']} (campaign {cites['digest'][:12]})" if "digest" in cites else cites["run"]


def lines(cites: Cited) -> list[str]:
    """The sentences on it."""
    unknown = f"The code version of {cites['run']} was not stored, so the code cannot be compared."
    found = [f"{cites['as']} extends {named(cites)}." if "as" in cites else f"Extends {named(cites)}."]
    return [*found, unknown] if "code" in cites and cites["code"] is None else found
