"""What is computed once for one snapshot of the database."""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa

from backend.db.engine import connected, once, one_snapshot, read
from tests.migrated import migrated

TIMES = sa.text("select count(*) from seen")


def counted(reader: sa.Connection) -> int:
    return once(reader, "count", lambda: reader.scalar(TIMES) or 0)


def test_a_reader_computes_once_what_a_writer_computes_at_each_call(tmp_path: Path) -> None:
    """Also a reader that goes on after its snapshot has ended has the newest one."""
    with connected(migrated(tmp_path)) as engine:
        with engine.begin() as writer:
            writer.execute(sa.text("create table seen (id integer)"))
            for n in range(2):
                assert (counted(writer), one_snapshot(writer)) == (n, False)
                writer.execute(sa.text("insert into seen values (1)"))
        with read(engine) as reader:
            assert (counted(reader), one_snapshot(reader)) == (2, True)
            with engine.begin() as writer:
                writer.execute(sa.text("insert into seen values (1)"))
            assert counted(reader) == reader.scalar(TIMES) == 2
            reader.rollback()
            assert counted(reader) == reader.scalar(TIMES) == 3
        with read(engine) as reader:
            assert counted(reader) == 3


def test_nothing_is_remembered_of_an_earlier_snapshot_whatever_begins_the_next_one(tmp_path: Path) -> None:
    with connected(migrated(tmp_path)) as engine:
        with engine.begin() as writer:
            writer.execute(sa.text("create table seen (id integer)"))
        with read(engine) as reader:
            for n, end in enumerate((reader.rollback, reader.commit, reader.close)):
                with engine.begin() as writer:
                    writer.execute(sa.text("insert into seen values (1)"))
                assert reader.scalar(TIMES) == counted(reader) == n + 1
                end()
            assert reader.closed
        with read(engine) as reader:
            for n in range(3, 5):
                with reader.begin():
                    assert counted(reader) == reader.scalar(TIMES) == n
                with engine.begin() as writer:
                    writer.execute(sa.text("insert into seen values (1)"))
