"""Which noise realisation a flight is simulated under again: its own, where it drew one, else those of the campaign.

The certify stage draws a realisation with every flight; a finding among those has its seed stored. Read `draws`.
"""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.tables import Finding, Stage
from campaigns.documents import JsonObject

WHOLE = 2**53


@dataclass(frozen=True)
class Noise:
    """One realisation, by its seed or by the number of the draw it came with; neither: those the campaign states."""

    seed: int | None = None
    draw: int | None = None
    """From 0 within the certify stage."""

    @property
    def request(self) -> dict[str, int]:
        """For the simulation process."""
        given = {"seed": self.seed, "draw": self.draw}
        return {name: value for name, value in given.items() if value is not None}


STATED = Noise()


def draws(reader: sa.Connection, run_id: int, document: JsonObject) -> dict[int, int]:
    """How many of the first evaluations of a stage each drew a realisation of their own, {position: count}.

    A stage reports it when it ends. One that has not ended has drawn at least what was asked for before it begins its
    grid; without noise a realisation changes nothing.
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
