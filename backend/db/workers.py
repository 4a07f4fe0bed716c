"""The heartbeats of the workers, their runs that stand still, and the catalogue published by the newest worker."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import codes
from backend.db.engine import insert, now
from backend.db.tables import CatalogueDocument, Run, Worker
from campaigns.catalogue import Catalogue, SimulatorEntry
from campaigns.runs import HELD
from campaigns.versions import Code

FORGOTTEN = 24 * 3600.0
"""A worker without a heartbeat for longer than this is no longer listed [s]."""

LIVE = 60.0
"""A worker is live if it sent a heartbeat within this time [s]; what it published stays for as long."""

CURRENT = 300.0
"""What is published counts as installed for so long after a live worker compared its files with it [s]: it pauses for
ten times as long as that took, and to publish an edit may take this long."""

RESTART = LIVE
"""And for so long after one has published or stopped in an orderly way, so that a restart shows no difference [s]."""

SEEN = 20.0
"""A worker counts as alive if it sent a heartbeat within this time, ten times the usual interval [s]."""


def recent(beat: float, at: float, within: float = SEEN) -> bool:
    """Whether a heartbeat was sent within this time. One further ahead is of a clock that has been put back since: it
    says nothing of whether the worker is alive."""
    return at - within < beat <= at + within


def beating(at: float, within: float = SEEN) -> sa.ColumnElement[bool]:
    """`recent`, of the rows of workers."""
    return sa.and_(Worker.beat > at - within, Worker.beat <= at + within)


@dataclass(frozen=True)
class Doing:
    """What a worker does besides the stages of its run: `compiling`, since when, and how long it takes if known [s]."""

    what: str
    run_id: int
    since: float
    seconds: float | None

    @classmethod
    def of(cls, stored: object, run_id: int | None) -> Doing | None:
        """What was stored, if it belongs to that run; None also for what another version stored."""
        try:
            found = cls(**stored) if isinstance(stored, dict) else None
        except TypeError:
            return None
        return found if found is not None and run_id is not None and found.run_id == run_id else None


def publish(connection: sa.Connection, catalogue: Catalogue, code: Code | None = None, worker: str = "") -> None:
    """Publish the catalogue against which campaigns are checked, and the installed code.

    Simulators that only other live workers have stay in it. worker: the name of the one that publishes.
    """
    own = {entry.name for entry in catalogue.simulators}
    elsewhere = [entry for entry in simulators(connection, worker) if entry.name not in own]
    before = (connection.scalar(sa.select(CatalogueDocument.document)) or {}).get("digests", {})
    digests = {entry.name: before[entry.name] for entry in elsewhere if entry.name in before} | catalogue.digests
    update = {"simulators": [*catalogue.simulators, *elsewhere], "digests": digests}
    catalogue = catalogue.model_copy(update=update)
    values = {"document": catalogue.model_dump(mode="json"), "published": now(connection)}
    values["code"] = None if code is None else code.digest
    if code is not None:
        codes.store(connection, code)
    row = insert(connection, CatalogueDocument).values(id=1, **values)
    connection.execute(row.on_conflict_do_update(index_elements=["id"], set_=values))


def correct(connection: sa.Connection, simulator: str, digest: str) -> None:
    """Publish the digest with which a run has just opened a simulator, if there is one published for it."""
    document = connection.scalar(sa.select(CatalogueDocument.document).with_for_update()) or {}
    if document.get("digests", {}).get(simulator, digest) != digest:
        corrected = {**document, "digests": {**document["digests"], simulator: digest}}
        connection.execute(sa.update(CatalogueDocument).values(document=corrected))


def published(connection: sa.Connection) -> float | None:
    """Time at which the catalogue was last published [s since 1970]; None if there is none."""
    return connection.scalar(sa.select(CatalogueDocument.published))


def arrive(connection: sa.Connection, name: str) -> None:
    at = now(connection)
    gone = sa.or_(Worker.name == name, ~beating(at, FORGOTTEN))
    connection.execute(sa.delete(Worker).where(gone))
    values = {"name": name, "host": socket.gethostname()[:120], "pid": os.getpid(), "started": at, "beat": at}
    connection.execute(sa.insert(Worker).values(**values))


def simulators(connection: sa.Connection, but: str = "") -> list[SimulatorEntry]:
    """The published simulators that a live worker has, other than that of this name; without those of which another
    version published an entry that this one cannot read."""
    live = (beating(now(connection), LIVE), Worker.name != but)
    known = connection.execute(sa.select(Worker.simulators).where(*live)).scalars()
    had = {version for versions in known for version in versions}
    document = connection.scalar(sa.select(CatalogueDocument.document)) or {}
    found = []
    for stored_entry in document.get("simulators", []):
        with contextlib.suppress(ValidationError):
            entry = SimulatorEntry.model_validate(stored_entry)
            found += [] if had.isdisjoint(entry.versions) else [entry]
    return found


def doing(connection: sa.Connection, name: str, run_id: int, what: str = "", seconds: float | None = None) -> None:
    """Record what the worker does besides the stages of its run; an empty `what` ends it. `seconds`: its estimate."""
    activity = asdict(Doing(what, run_id, now(connection), seconds)) if what else None
    connection.execute(sa.update(Worker).where(Worker.name == name).values(doing=activity))


def beat(
    connection: sa.Connection,
    name: str,
    run_id: int | None,
    simulators: Sequence[str] = (),
    installation: str = "",
    age: float | None = None,
    short: bool = False,
) -> bool:
    """Whether it is to take no further run.

    age: time since it began to compare its files with what it has published, if they are the same [s].
    short: whether it begins no run, because too little space is left where it writes.
    """
    at = now(connection)
    values = {"beat": at, "run_id": run_id, "simulators": list(simulators), "installation": installation}
    values |= {"short": short} | ({} if age is None else {"compared": at - age})
    beaten = sa.update(Worker).where(Worker.name == name).values(**values).returning(Worker.draining)
    return bool(connection.scalar(beaten))


def drain(connection: sa.Connection, name: str) -> int | None:
    """Ask a live worker to take no further run and to end; returns its run, if it has one. Raises `KeyError`."""
    live = (Worker.name == name, beating(now(connection), LIVE))
    drain_update = sa.update(Worker).where(*live).values(draining=True).returning(Worker.name, Worker.run_id)
    row = connection.execute(drain_update).first()
    if row is None:
        raise KeyError(name)
    run: int | None = row.run_id
    return run


def compared(connection: sa.Connection, simulator: str | None) -> float | None:
    """When every worker that may run a campaign with this simulator (None: without one) had compared its files with
    what it has published [s since 1970]; None if there is no such worker."""
    alive = sa.select(Worker.simulators, Worker.compared).where(beating(now(connection)))
    able = [at for versions, at in connection.execute(alive) if simulator is None or simulator in versions]
    return min(able, default=None)


@dataclass(frozen=True)
class Report:
    """What live workers report of what is published. at: when one of them, or of those before, last had it installed;
    seen: when any was last seen; simulators: the versions that live ones have, None if all count as theirs."""

    at: float
    seen: float
    alive: bool
    current: bool
    simulators: frozenset[str] | None

    def has(self, entry: SimulatorEntry) -> bool:
        return self.simulators is None or not self.simulators.isdisjoint(entry.versions)


def reported(connection: sa.Connection) -> Report | None:
    """Whether what is published is installed, as far as workers report it; None if nothing is published.

    A worker that has just published, or stopped in an orderly way, counts as live: a restart shows no difference. One
    that could not yet start its process does not report anything.
    """
    stored = connection.execute(sa.select(CatalogueDocument.published, CatalogueDocument.departed)).first()
    if stored is None:
        return None
    at = now(connection)
    events = [when for when in stored if when is not None]
    lately = any(recent(when, at, RESTART) for when in events)
    live = connection.execute(sa.select(Worker.compared, Worker.simulators).where(beating(at, LIVE))).all()
    compared = max((row.compared for row in live), default=0.0)
    return Report(
        at=max(compared, *(when for when in events if when <= at), 0.0),
        seen=max(last_seen(connection) or 0.0, stored.published),
        alive=bool(live),
        current=lately or compared > at - CURRENT,
        simulators=None if lately else frozenset(version for row in live for version in row.simulators),
    )


def leave(connection: sa.Connection, name: str) -> None:
    """Delete the entry of a worker after an orderly shutdown; only the time is stored, if it had been able to run."""
    ready = sa.select(Worker.name).where(Worker.name == name, Worker.installation != "").exists()
    connection.execute(sa.update(CatalogueDocument).where(ready).values(departed=now(connection)))
    connection.execute(sa.delete(Worker).where(Worker.name == name))


def last_seen(connection: sa.Connection) -> float | None:
    """When any worker was last seen, by its heartbeat or its orderly stop [s since 1970]; None if it is not known."""
    possible = Worker.beat <= now(connection) + SEEN  # not of a clock that has been put back since
    beaten = connection.scalar(sa.select(sa.func.max(Worker.beat)).where(possible))
    left = connection.scalar(sa.select(sa.func.max(CatalogueDocument.departed)))
    return max((at for at in (beaten, left) if at is not None), default=None)


def live(connection: sa.Connection) -> list[str]:
    """The names of the live workers."""
    found = sa.select(Worker.name).where(beating(now(connection), LIVE)).order_by(Worker.name)
    return list(connection.scalars(found))


def alive(connection: sa.Connection, host: str) -> bool:
    """Whether a worker on that machine is live."""
    found = sa.select(Worker.name).where(Worker.host == host[:120], beating(now(connection), LIVE))
    return connection.scalar(found.limit(1)) is not None


STILL = 600.0
"""A run that stored no evaluation for this long stands still [s]."""


def standing_still(reader: sa.Connection) -> dict[int, float]:
    """Their numbers, with the time of the last evaluation, or since when a worker has them [s since 1970].

    Nothing is known of a run whose worker is of a version that does not store it.
    """
    still = sa.select(Run.id, Run.advanced).where(Run.state.in_(HELD), Run.advanced < now(reader) - STILL)
    return {row.id: row.advanced for row in reader.execute(still.order_by(Run.id))}
