"""How a run's methods, obstacles and vehicle are drawn, from its snapshot and the current catalogue."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.catalog.service import published, snapshot_of
from campaigns import Catalogue
from campaigns.catalogue import ComponentEntry, MethodEntry, Role
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook


@dataclass(frozen=True)
class Looks:
    """Looks by name, from the snapshot of a run and from the current catalogue.

    Methods always have their current colour. Sizes refer to parameters of the snapshot; for snapshots of earlier
    versions, which have no looks, the current looks are used if their parameters match.
    """

    kept: Catalogue | None = None
    installed: Catalogue | None = None

    def method(self, name: str) -> MethodLook | None:
        return next((entry.look for entry in self._methods(name) if entry.look is not None), None)

    def random(self, name: str) -> bool:
        """Whether a search method draws from the distributions."""
        return any(entry.kind == "random" for entry in self._methods(name))

    def obstacle(self, name: str) -> ObstacleLook | None:
        return next((e.look for e in self._entries("obstacle", name) if isinstance(e.look, ObstacleLook)), None)

    def vehicle(self, name: str) -> VehicleLook | None:
        return next((e.look for e in self._entries("vehicle", name) if isinstance(e.look, VehicleLook)), None)

    def _methods(self, name: str) -> list[MethodEntry]:
        found = [known.method(name) for known in (self.installed, self.kept) if known is not None]
        return [entry for entry in found if entry is not None]

    def _entries(self, role: Role, name: str) -> list[ComponentEntry]:
        found = [known.component(role, name) for known in (self.kept, self.installed) if known is not None]
        return [entry for entry in found if entry is not None]


def looks(reader: sa.Connection, run_id: int) -> Looks:
    return Looks(snapshot_of(reader, run_id), published(reader))
