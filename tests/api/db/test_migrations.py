"""The migrations create exactly the declared tables, from an empty database and with concurrent starts."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory

from backend.db import revision
from backend.db.engine import NewerSchemaError, connect, default_url, migrate
from backend.db.migrate import config
from backend.db.tables import Base
from campaigns.refusals import RefusalCode
from tests.given.refused_commands import refused


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[sa.Engine]:
    engine = connect(default_url(tmp_path))
    yield engine
    engine.dispose()


def difference(engine: sa.Engine) -> list[object]:
    with engine.connect() as connection:
        return list(compare_metadata(MigrationContext.configure(connection), Base.metadata))


def test_the_newest_form_is_that_of_the_code(engine: sa.Engine, tmp_path: Path) -> None:
    assert difference(engine)
    migrate(default_url(tmp_path))
    assert difference(engine) == []


def test_migrating_again_changes_nothing(engine: sa.Engine, tmp_path: Path) -> None:
    migrate(default_url(tmp_path))
    with engine.begin() as connection:
        connection.execute(sa.text("insert into catalogue (id, document, published) values (1, '{}', 0)"))
    migrate(default_url(tmp_path))
    with engine.connect() as connection:
        assert connection.scalar(sa.text("select count(*) from catalogue")) == 1


def test_the_newest_file_is_the_newest_revision(engine: sa.Engine, tmp_path: Path) -> None:
    with engine.connect() as connection:
        assert revision.stored(connection) is None
        assert ScriptDirectory.from_config(config(connection)).get_heads() == [revision.newest()]
    migrate(default_url(tmp_path))
    with engine.connect() as connection:
        assert revision.stored(connection) == revision.newest()


def test_a_database_of_a_later_version_is_refused(engine: sa.Engine, tmp_path: Path) -> None:
    migrate(default_url(tmp_path))
    with engine.begin() as connection:
        connection.execute(sa.text("update alembic_version set version_num = '9999'"))
    with pytest.raises(NewerSchemaError, match="9999"):
        migrate(default_url(tmp_path))


@pytest.mark.parametrize("command", ["audit", "replay"])
def test_a_command_that_only_reads_refuses_another_schema(
    command: str, engine: sa.Engine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of an earlier version it named the first column that it did not find, as if there were no run."""
    migrate(default_url(tmp_path))
    for stored in (sorted(revision.known())[-2], "9999"):
        with engine.begin() as connection:
            connection.execute(sa.text("update alembic_version set version_num = :stored"), {"stored": stored})
        assert refused(capsys, command, "R-0001", "--data", tmp_path) == RefusalCode.OTHER_SCHEMA


def test_a_migration_that_fails_leaves_nothing(engine: sa.Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sa.Engine, "dispose", lambda _: None)
    monkeypatch.setattr("backend.db.engine.connect", lambda _: engine)
    with engine.begin() as connection:
        connection.execute(sa.text("create table tokens (id integer)"))  # in the way of the first revision
    with pytest.raises(sa.exc.OperationalError):
        migrate("sqlite:///ignored")
    with engine.connect() as connection:
        assert sa.inspect(connection).get_table_names() == ["tokens"]


@pytest.mark.nightly
def test_two_processes_on_a_fresh_file_both_succeed(engine: sa.Engine, tmp_path: Path) -> None:
    """The other one is that of the tests."""
    url = default_url(tmp_path)
    program = "import sys; from backend.db.engine import migrate; print('ready'); input(); migrate(sys.argv[1])"
    command = [sys.executable, "-u", "-c", program, url]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdin is not None
        assert other.stdout is not None
        assert other.stdout.readline() == "ready\n"
        print(file=other.stdin, flush=True)
        migrate(url)
        assert other.wait(60) == 0
    assert difference(engine) == []
