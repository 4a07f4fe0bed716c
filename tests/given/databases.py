"""The databases on which a test of the service runs; SQLite by default."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.db.engine import connect, migrate
from tests.faults import postgres

Fresh = Callable[[Path], str]
"""Makes the empty database of a service; its URL."""

KINDS = ("sqlite", "postgresql")

BOTH = pytest.mark.parametrize("database", KINDS, indirect=True)
"""What is claimed of one database is claimed of both; without a PostgreSQL server that half is skipped."""

AT_NIGHT = pytest.mark.parametrize(
    "database", [KINDS[0], pytest.param(KINDS[1], marks=pytest.mark.nightly)], indirect=True
)
"""The same, by day on SQLite alone: what locks, sorts, deletes or inserts as PostgreSQL does is tested on it by day."""

POSTGRESQL = pytest.mark.parametrize("database", KINDS[1:], indirect=True)


def as_of(writer: sa.Connection, revision: str) -> None:
    """Make the database one of an earlier revision, whose data the caller writes: with the columns that were there."""
    added = [("campaigns", "question varchar(64)"), ("run_requirements", "question varchar(64)")]
    if revision < "0034":
        added.append(("runs", "cancel boolean"))
    for table, column in added:
        writer.execute(sa.text(f"alter table {table} add column {column}"))
    writer.execute(sa.text("create index ix_campaigns_question on campaigns (question)"))
    writer.execute(sa.text("drop index ix_runs_question"))
    writer.execute(sa.text("alter table runs drop column question"))
    writer.execute(sa.text("alter table runs drop column made_again"))
    writer.execute(sa.text("alter table runs drop column later"))
    writer.execute(sa.text("alter table signoffs drop column known"))
    writer.execute(sa.text("alter table runs drop column bounds"))
    writer.execute(sa.text("drop table questions"))
    writer.execute(sa.text(f"update alembic_version set version_num = '{revision}'"))


@contextmanager
def on_postgresql() -> Iterator[Fresh]:
    """Copies a migrated database, and drops unused ones, each of which has 8 MB."""
    with postgres.server() as server:
        engine = connect(server.url).execution_options(isolation_level="AUTOCOMMIT")
        numbers = itertools.count(1)
        unused = (
            "select d.datname from pg_database d left join pg_stat_activity a on a.datid = d.oid "
            "where d.datname like 'service_%' and a.pid is null"
        )

        def create(name: str, more: str = "") -> str:
            with engine.connect() as connection:
                for over in connection.scalars(sa.text(unused)).all():
                    connection.execute(sa.text(f"drop database {over}"))
                connection.execute(sa.text(f"create database {name}{more}"))
            return sa.make_url(server.url).set(database=name).render_as_string(hide_password=False)

        migrate(create("migrated"))

        def made(data: Path) -> str:
            data.mkdir()
            return create(f"service_{next(numbers)}", " template migrated")

        try:
            yield made
        finally:
            engine.dispose()
