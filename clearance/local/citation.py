"""The run that another one extends, as result.json and the report state it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from campaigns import Campaign
    from campaigns.versions import Versions
    from worker.running.runs.store import MemoryStore

Cited = TypedDict("Cited", {"as": str, "run": str, "digest": str, "code": None}, total=False)
"""The run that is extended, and the number of the new one in the database; code: its version was not stored."""


@dataclass(frozen=True)
class Earlier:
    """What is extended, by its name: its campaign, its evaluations, and what evaluated them."""

    name: str
    campaign: Campaign
    store: MemoryStore
    versions: Versions
    violated: bool = False
    """Whether its verdict is, where its store has no findings."""

    @property
    def cited(self) -> Cited:
        cited: Cited = {"run": self.name, "digest": self.campaign.digest}
        return cited if self.versions.code else {**cited, "code": None}


def named(cites: Cited) -> str:
    """The run that is extended, with its campaign where that is known."""
    return f"{cites['run']} (campaign {cites['digest'][:12]})" if "digest" in cites else cites["run"]


def lines(cites: Cited) -> list[str]:
    """The sentences on it."""
    unknown = f"The code version of {cites['run']} was not stored, so the code cannot be compared."
    found = [f"{cites['as']} extends {named(cites)}." if "as" in cites else f"Extends {named(cites)}."]
    return [*found, unknown] if "code" in cites and cites["code"] is None else found
