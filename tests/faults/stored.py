"""Reads stored runs while a worker in another process writes them."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.engine import read
from backend.db.tables import Run
from tests.faults.processes import until


class Stored:
    """A database in which runs are watched."""

    engine: sa.Engine

    def run(self, run_id: int) -> Any:
        with read(self.engine) as connection:
            return connection.execute(sa.select(Run).where(Run.id == run_id)).one()

    def ended(self, run_id: int) -> Any:
        until(lambda: self.run(run_id).state in ("done", "failed", "cancelled"), f"run {run_id} ends")
        return self.run(run_id)
