"""A service for each test, with its own database copied from one that was migrated once."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from backend.db.engine import default_url
from backend.scenes.live.live import Live
from backend.settings import Settings
from tests import migrated as empty
from tests.given.databases import KINDS, Fresh, on_postgresql
from tests.given.service import Service


@pytest.fixture(scope="session")
def migrated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an empty database of the newest form."""
    folder = tmp_path_factory.mktemp("migrated")
    empty.migrated(folder)
    return folder


@pytest.fixture(scope="session")
def fresh_sqlite(migrated: Path) -> Fresh:
    """Makes an empty database for a data folder that is not there yet."""

    def made(data: Path) -> str:
        shutil.copytree(migrated, data)
        return default_url(data)

    return made


@pytest.fixture(scope="session")
def fresh_postgresql() -> Iterator[Fresh]:
    """A fresh database on a PostgreSQL server; skipped if there is none."""
    with on_postgresql() as made:
        yield made


@pytest.fixture
def database(request: pytest.FixtureRequest) -> str:
    """Which database the service of a test has; see `tests.given.databases`."""
    return str(getattr(request, "param", KINDS[0]))


@pytest.fixture
def fresh(database: str, request: pytest.FixtureRequest) -> Fresh:
    """Makes an empty database of that kind."""
    return request.getfixturevalue(f"fresh_{database}")  # type: ignore[no-any-return]


@contextmanager
def running(fresh: Fresh, folder: Path, **settings: Any) -> Iterator[Service]:
    """A service without a catalogue and without pages."""
    data = folder / "data"
    service = Service(Settings(data=data, database=fresh(data), pages=folder / "dist", **settings))
    service.start()
    try:
        yield service
    finally:
        service.stop()


@pytest.fixture
def bare(fresh: Fresh, tmp_path: Path) -> Iterator[Service]:
    """A separate service, before any worker has started."""
    with running(fresh, tmp_path) as service:
        yield service


@pytest.fixture
def service(bare: Service) -> Service:
    """A service with a catalogue."""
    bare.publish()
    return bare


@pytest.fixture(scope="session")
def process() -> Iterator[Live]:
    """The process of what-if simulations, which takes seconds to start; it waits while a cold cache compiles."""
    live = Live(first_limit=120.0)
    yield live
    live.close()


@pytest.fixture
def simulating(bare: Service, process: Live) -> Service:
    """A separate service whose simulations are made by the shared process."""
    bare.app.state.live = process
    return bare


@pytest.fixture
def client(service: Service) -> Iterator[httpx.Client]:
    """A browser that has opened the login link."""
    with service.signed_in() as client:
        yield client


@pytest.fixture(scope="module")
def still(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with a catalogue, shared by the tests that leave nothing in it."""
    with running(fresh_sqlite, tmp_path_factory.mktemp("still")) as service:
        service.publish()
        yield service


@pytest.fixture(scope="module")
def guest(still: Service) -> Iterator[httpx.Client]:
    """A browser that has opened the shared service's login link."""
    with still.signed_in() as client:
        yield client
