"""What `clearance check-simulator` measured: the newest measurement of each simulator and version of its files."""

from __future__ import annotations

import socket
from dataclasses import dataclass

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db.engine import insert, now
from backend.db.tables import SimulatorMeasurement
from campaigns.catalogue import SimulatorEntry
from campaigns.results.measured import Measured

RECENT = 50
"""Number of stored measurements of a simulator that are read, the newest ones."""


@dataclass(frozen=True)
class Stored:
    """One measurement: when [s since 1970], on which machine, and the digest of the simulator's files."""

    at: float
    host: str
    digest: str
    measured: Measured


def store(writer: sa.Connection, entry: SimulatorEntry, digest: str, measured: Measured) -> None:
    """Store the measurement; it replaces the earlier one of the same declaration and files."""
    values = {
        "measured": now(writer),
        "host": socket.gethostname()[:120],
        "result": measured.model_dump(mode="json"),
    }
    row = insert(writer, SimulatorMeasurement).values(simulator=entry.version, digest=digest[:128], **values)
    key = [SimulatorMeasurement.simulator, SimulatorMeasurement.digest]
    writer.execute(row.on_conflict_do_update(index_elements=key, set_=values))


def stored(reader: sa.Connection, entry: SimulatorEntry) -> list[Stored]:
    """The measurements of the simulator with this declaration, the newest first; without those that another version of
    this program stored and this one cannot read."""
    table = SimulatorMeasurement
    query = sa.select(table.measured, table.host, table.digest, table.result).where(table.simulator == entry.version)
    found = []
    for at, host, digest, result in reader.execute(query.order_by(table.measured.desc()).limit(RECENT)):
        try:
            found.append(Stored(at, host, digest, Measured.model_validate(result)))
        except ValidationError:
            continue
    return found
