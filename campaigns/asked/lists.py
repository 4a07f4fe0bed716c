"""The listed parts of a scenario (obstacles, environment, faults), and the prefixes of their paths."""

from __future__ import annotations

from campaigns.asked.scenario import FaultPart
from campaigns.asked.spec import Campaign

LISTS = ("obstacles", "environment", "faults")


def components(campaign: Campaign) -> dict[str, str]:
    """The component of every listed part, and what it acts on, by the prefix of its paths."""
    found: dict[str, str] = {}
    for name in LISTS if campaign.scenario is not None else ():
        for i, part in enumerate(getattr(campaign.scenario, name)):
            on = part.on if isinstance(part, FaultPart) else ""
            found[f"{name}.{i}"] = f"{part.component} on {on}" if on else part.component
    return found


def prefix_of(path: str) -> str:
    """The prefix of a listed part's path, such as `obstacles.0`; empty for any other path."""
    name, _, rest = path.partition(".")
    return f"{name}.{rest.partition('.')[0]}" if name in LISTS else ""
