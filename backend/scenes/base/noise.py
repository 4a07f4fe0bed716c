"""The noise realisation with which a flight is repeated: its own if it drew one, else those of the campaign.

The certify stage draws one realisation per flight; a finding among these has its seed stored.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from backend.db.tables import Finding, Stage

WHOLE = 2**53


@dataclass(frozen=True)
class Noise:
    """One realisation, by its seed or by the index of its draw; if neither is given, those of the campaign."""

    seed: int | None = None
    draw: int | None = None
    """Index from 0 within the certify stage."""

    @property
    def request(self) -> dict[str, int]:
        """The fields of the request to the simulation process."""
        given = {"seed": self.seed, "draw": self.draw}
        return {name: value for name, value in given.items() if value is not None}


STATED = Noise()


def draws(reader: sa.Connection, run_id: int, document: Mapping[str, Any]) -> dict[int, int]:
    """The number of leading evaluations of a stage that each drew their own realisation, {position: count}.

    A stage reports it when it ends. Until then it has drawn at least the requested number before it starts its grid;
    without noise a realisation has no effect.
    """
    query = sa.select(Stage.position, Stage.result).where(Stage.run_id == run_id, Stage.kind == "certify")
    asked = document.get("stages", {}).get("certify") or {}
    begun = int(asked.get("samples", 0)) if asked.get("grid") else WHOLE
    return {
        row.position: begun if row.result is None else int(row.result.get("drawn_realisations") or 0)
        for row in reader.execute(query).all()
    }


def seeds(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """The seeds of the findings that drew a realisation of their own, by label."""
    rows = reader.execute(sa.select(Finding.label, Finding.validation).where(Finding.run_id == run_id)).all()
    found = {row.label: (row.validation or {}).get("realisation") for row in rows}
    return {label: int(seed) for label, seed in found.items() if seed is not None}
