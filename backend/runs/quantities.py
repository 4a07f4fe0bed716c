"""The quantity and unit that a run is judged by: those of its verdict, before that those of the installed catalogue.

The single source for lists and comparisons.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db.tables import CampaignRow, Run

COLUMNS = (
    *(CampaignRow.document["criterion"][key].as_string().label(key) for key in ("component", "result")),
    *(Run.summary[key].as_string().label(key) for key in ("quantity", "unit")),
)
"""The columns that `of` needs besides those of `identity`."""


class Measured(NamedTuple):
    """Fields of the same names of a summary and of an outcome; empty if they are not known."""

    quantity: str
    unit: str


Installed = dict[tuple[str | None, str], Measured]
"""By simulator (None for a scenario) and criterion."""


def installed(reader: sa.Connection, rows: Sequence[Any]) -> Installed:
    """What the catalogue describes; read only if one of these runs has no verdict."""
    catalogue = published(reader) if any(row.unit is None for row in rows) else None
    if catalogue is None:
        return {}
    found: Installed = {
        (None, c.name): Measured(c.quantity, c.unit) for c in catalogue.components if c.role == "criterion"
    }
    return found | {(s.name, r.name): Measured(r.quantity, r.unit) for s in catalogue.simulators for r in s.results}


def of(row: Any, described: Installed) -> Measured:
    named = row.result if row.simulator else row.component
    known = described.get((row.simulator, named), Measured("", ""))
    return Measured(row.quantity or known.quantity, known.unit if row.unit is None else row.unit)
