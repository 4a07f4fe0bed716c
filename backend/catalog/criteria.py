"""The criteria of a campaign as described by the catalogue: the deciding one, then the objectives.

Their names are those used in results (`campaigns.asked.criteria.named`), in the order of the cost columns.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from backend.catalog.schemas import CriterionOut
from campaigns import Catalogue
from campaigns.asked.criteria import named
from campaigns.catalogue import ComponentEntry, ResultEntry

EARLIER: dict[str, Literal["centre"]] = {"separation": "centre"}
"""Default for snapshots that are older than this declaration."""


def criteria(document: Mapping[str, Any], catalogue: Catalogue | None) -> list[CriterionOut]:
    """All criteria of a campaign's document with unique names; those not in the catalogue have no description."""
    if document.get("simulator"):
        return [_result(document, catalogue)]
    found: list[CriterionOut] = []
    components = [str(part["component"]) for part in (document["criterion"], *document.get("objectives", []))]
    for name, component in zip(named(components), components, strict=True):
        entry = None if catalogue is None else catalogue.component("criterion", component)
        stated = entry.measured_to if entry else ""
        ends = "" if stated == "none" else stated or EARLIER.get(component, "")
        found.append(_described(name, component, entry, ends))
    return found


def _result(document: Mapping[str, Any], catalogue: Catalogue | None) -> CriterionOut:
    name, simulator = str(document["criterion"]["result"]), str(document["simulator"]["name"])
    known = None if catalogue is None else catalogue.simulator(simulator)
    entry = None if known is None else known.result(name)
    return _described(name, name, entry, "")


def _described(
    name: str, component: str, entry: ComponentEntry | ResultEntry | None, ends: Literal["", "centre", "surface"]
) -> CriterionOut:
    return CriterionOut(
        name=name,
        component=component,
        title=entry.title if entry else component,
        quantity=entry.quantity if entry else "",
        unit=entry.unit if entry else "",
        worse="high" if entry and entry.worse == "high" else "low",
        measured_to=ends,
    )
