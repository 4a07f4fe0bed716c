"""What workers publish of simulators: corrected by runs that open them, gone with the last worker that has one."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import workers
from backend.db.tables import CatalogueDocument
from campaigns.catalogue import Catalogue
from tests.given.service import Service
from tests.given.timed_simulators import ENTRY, METHODS, publish, run


def published(service: Service) -> Catalogue:
    with service.engine.connect() as connection:
        return Catalogue.model_validate(connection.scalar(sa.select(CatalogueDocument.document)))


def test_the_digest_of_a_run_corrects_the_catalogue(bare: Service) -> None:
    publish(bare, "aa")
    run(bare, "aa", None)
    assert published(bare).digests == {ENTRY.name: "aa"}
    run(bare, "bb", None)
    assert published(bare).digests == {ENTRY.name: "bb"}


def test_a_simulator_without_a_published_digest_gets_none_by_a_run(bare: Service) -> None:
    publish(bare, None)
    run(bare, "bb", None)
    assert published(bare).digests == {}


def test_a_worker_that_no_longer_has_a_simulator_takes_it_out_unless_another_has_it(bare: Service) -> None:
    without = Catalogue(version="1", components=[], methods=METHODS)
    publish(bare)
    with bare.engine.begin() as connection:
        for name in ("w1", "w2"):
            workers.arrive(connection, name)
            workers.beat(connection, name, None, [ENTRY.version])
        workers.publish(connection, without, worker="w1")
    assert [one.name for one in published(bare).simulators] == [ENTRY.name], "w2 has it"
    with bare.engine.begin() as connection:
        workers.leave(connection, "w2")
        workers.publish(connection, without, worker="w1")
    assert published(bare).simulators == []
