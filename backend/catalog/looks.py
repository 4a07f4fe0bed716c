"""How a run's methods, obstacles and vehicle are drawn, from what the run kept and what is installed.

Start reading at `Looks`.
"""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db import snapshots
from campaigns import Catalogue
from campaigns.catalogue import ComponentEntry, Role
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook


@dataclass(frozen=True)
class Looks:
    """Looks by name, from the snapshot of a run and from today's catalogue.

    A method has its colour of today in every run. Sizes are named by parameters, which are those of the snapshot; one
    of an earlier version has no looks, and today's are taken where they fit.
    """

    kept: Catalogue | None = None
    installed: Catalogue | None = None

    def method(self, name: str) -> MethodLook | None:
        """Of a search method; None where nothing declares one."""
        entries = [known.method(name) for known in (self.installed, self.kept) if known is not None]
        return next((entry.look for entry in entries if entry is not None and entry.look is not None), None)

    def obstacle(self, name: str) -> ObstacleLook | None:
        """Of an obstacle; None where nothing declares one."""
        return next((e.look for e in self._entries("obstacle", name) if isinstance(e.look, ObstacleLook)), None)

    def vehicle(self, name: str) -> VehicleLook | None:
        """Of a vehicle; None where nothing declares one."""
        return next((e.look for e in self._entries("vehicle", name) if isinstance(e.look, VehicleLook)), None)

    def _entries(self, role: Role, name: str) -> list[ComponentEntry]:
        found = [known.component(role, name) for known in (self.kept, self.installed) if known is not None]
        return [entry for entry in found if entry is not None]


def looks(reader: sa.Connection, run_id: int) -> Looks:
    """Of a run's components and methods."""
    return Looks(snapshots.of_run(reader, run_id), published(reader))
