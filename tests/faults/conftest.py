"""Databases for the fault tests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.db.engine import connect, migrate
from backend.db.roles import LOCAL
from backend.db.tables import Base
from tests.faults import postgres
from tests.migrated import migrated


@pytest.fixture(scope="session")
def server() -> Iterator[postgres.Server]:
    """A PostgreSQL server."""
    with postgres.server() as running:
        yield running


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[sa.Engine]:
    """An empty database of each kind."""
    if request.param == "sqlite":
        url = migrated(tmp_path)
    else:
        migrate(url := request.getfixturevalue("server").url)
    engine = connect(url)
    yield engine
    if request.param == "postgresql":
        with engine.begin() as connection:
            names = ", ".join(table.name for table in Base.metadata.sorted_tables if table.name != "users")
            connection.execute(sa.text(f"truncate {names} restart identity cascade"))
            # as the migrations leave it
            connection.execute(sa.text("delete from users where name <> :kept"), {"kept": LOCAL})
    engine.dispose()
