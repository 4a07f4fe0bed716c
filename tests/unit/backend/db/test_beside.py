"""Files beside the SQLite file: connections that come and go at the same time are told from deleted files."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.db.engine import connect
from backend.db.outages import DatabaseOutage
from tests.given.at_night import nightly_but
from tests.migrated import migrated

AT_ONCE = 4
TIMES = pytest.mark.parametrize("times", nightly_but((25,), (25, 100)))


def used(engine: sa.Engine, times: int) -> None:
    for _ in range(times):
        with engine.begin() as connection:
            connection.execute(sa.text("select 1"))
        engine.dispose()


@TIMES
def test_what_sqlite_itself_deletes_with_the_last_connection_is_no_loss(tmp_path: Path, times: int) -> None:
    url = migrated(tmp_path)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        list(pool.map(lambda _: used(connect(url), times), range(2 * AT_ONCE)))


@TIMES
def test_one_engine_used_and_emptied_by_several_threads_loses_nothing(tmp_path: Path, times: int) -> None:
    url = migrated(tmp_path)
    engine = connect(url)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        list(pool.map(lambda _: used(engine, times), range(2 * AT_ONCE)))


@pytest.mark.parametrize("ending", ["-wal", "-shm"])
def test_a_deleted_file_is_found_while_a_connection_is_open_and_after_it(tmp_path: Path, ending: str) -> None:
    url = migrated(tmp_path)
    engine = connect(url)
    with engine.connect():
        (tmp_path / f"clearance.sqlite3{ending}").unlink()
        for _ in range(2):
            with pytest.raises(DatabaseOutage, match="were deleted"):
                used(connect(url), 1)
    engine.dispose()
    with pytest.raises(DatabaseOutage, match="were deleted"):
        used(connect(url), 1)
