"""What counts as installed: only what a live worker reports, or one that was there a moment ago."""

from __future__ import annotations

import time

import pytest
import sqlalchemy as sa

from backend.catalog.installation import Installation, installation, no_report, no_worker
from backend.db import workers
from backend.db.tables import CatalogueDocument, Worker
from campaigns.catalogue import SimulatorEntry
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE
from tests.given.timed_simulators import ENTRY

NIGHT = 8 * 3600.0
OTHER = ENTRY.model_copy(update={"name": "other"})


def found(service: Service) -> Installation:
    with service.engine.connect() as reader:
        return installation(reader)


def published(service: Service, age: float, *simulators: SimulatorEntry) -> float:
    """What a worker published so long ago; returns when."""
    digests = {entry.name: f"digest of {entry.name}" for entry in simulators}
    catalogue = CATALOGUE.model_copy(update={"simulators": list(simulators), "digests": digests})
    service.publish(catalogue.model_dump(mode="json"))
    at = time.time() - age
    with service.engine.begin() as connection:
        connection.execute(sa.update(CatalogueDocument).values(published=at))
    return at


def arrive(service: Service, age: float | None, *has: SimulatorEntry, loaded: str = "here") -> None:
    """A live worker that compared its files so long ago; None if its process has not started yet."""
    with service.engine.begin() as connection:
        workers.arrive(connection, "w1")
        workers.beat(connection, "w1", None, [entry.version for entry in has], loaded, age)


def test_what_was_published_counts_only_while_a_worker_reports_it(bare: Service) -> None:
    at = published(bare, NIGHT)
    assert found(bare) == Installation(None, no_worker(at))
    arrive(bare, None, loaded="")
    assert found(bare) == Installation(None, no_report(at)), "it may be about to publish an edit"
    arrive(bare, 100.0)
    assert found(bare).catalogue is not None
    arrive(bare, 2 * workers.CURRENT)
    assert found(bare).reason.startswith(no_report(0.0).partition("1970")[0])


@pytest.mark.parametrize("loaded", ["", "here"])
def test_a_restart_shows_no_difference_but_one_that_never_starts_does(bare: Service, loaded: str) -> None:
    at = published(bare, NIGHT)
    arrive(bare, None, loaded=loaded)
    with bare.engine.begin() as connection:
        workers.leave(connection, "w1")
    assert found(bare).reason == ("" if loaded else no_worker(at))
    with bare.engine.begin() as connection:
        connection.execute(sa.update(CatalogueDocument).values(departed=time.time() - workers.RESTART - 1))
    assert found(bare).reason.startswith(no_worker(0.0).partition("1970")[0])


def test_a_worker_that_was_killed_stops_counting(bare: Service) -> None:
    published(bare, NIGHT)
    arrive(bare, 1.0)
    last = time.time() - workers.LIVE - 1
    with bare.engine.begin() as connection:
        connection.execute(sa.update(Worker).values(beat=last, compared=last))
    assert found(bare).reason == no_worker(last)


def test_a_simulator_that_no_live_worker_has_is_not_compared(bare: Service) -> None:
    """Others are: nobody has published since its worker was lost."""
    published(bare, NIGHT, ENTRY, OTHER)
    arrive(bare, 1.0, OTHER)
    now = found(bare)
    assert now.catalogue is not None
    assert (set(now.absent), list(now.catalogue.digests)) == ({ENTRY.name}, [OTHER.name])
