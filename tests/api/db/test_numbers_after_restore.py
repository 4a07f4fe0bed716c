"""Numbers after `clearance restore`: no number that the former database had given is given again."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.db import numbers
from backend.db.backup import backup, restore
from backend.db.engine import connected
from backend.db.tables import Base
from clearance.cli import invoke
from tests.given.databases import AT_NIGHT
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit, swept
from tests.migrated import migrated


def given(service: Service) -> dict[str, int]:
    """Make one row of everything that has a number; returns the numbers by table."""
    with service.signed_in() as browser:
        run = submit(browser)
        finish_fully(service)
        at = f"/api/v1/runs/{run}/signoffs"
        review = {"name": "Grace", "role": "Review", "comment": "Read.", "digest": browser.get(at).json()["digest"]}
        assert browser.post(at, json=review).status_code == 201
        file = {"name": f"{run}.csv", "kind": "csv"}
        imported = browser.post("/api/v1/requirements/files", params=file, content=f"id,text\n{run},Keep away.\n")
        assert imported.is_success, imported.text
        draft = browser.post("/api/v1/drafts", json={"name": "Draft", "tags": [], "text": "name: x\n"}).json()
        sweep = swept(browser, [1.0, 2.0])
        browser.post(f"/api/v1/sweeps/{sweep['id']}/cancel")
    with service.engine.connect() as reader:
        last = {name: reader.scalar(sa.text(f"select max(id) from {name}")) or 0 for name in numbers.TABLES}
    with service.signed_in() as browser:  # the highest number is then in no row
        old = browser.get(f"/api/v1/drafts/{draft['id']}")
        assert browser.delete(f"/api/v1/drafts/{draft['id']}", headers={"If-Match": old.headers["etag"]}).is_success
    return last


@AT_NIGHT
def test_no_number_is_given_again_after_a_restore(
    service: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    url, file = service.settings.database, tmp_path / "backup"
    assert url is not None
    first = given(service)
    backup(url, file)
    given(service)
    last = given(service)
    assert all(last[name] > first[name] for name in numbers.TABLES)
    service.stop()
    for _ in range(2):  # also after the second restore of the same backup
        with service.engine.begin() as writer:
            writer.execute(sa.text("delete from workers"))
        service.engine.dispose()
        assert invoke(["restore", str(file), "--yes", "--data", str(tmp_path / "data"), "--database", url]) == 0
        told = capsys.readouterr().out
        assert re.findall(r"[RS]-\d+", told) == [f"R-{last['runs'] + 1:04d}", f"S-{last['sweeps'] + 1:04d}"]
        again = Service(service.settings)
        again.start()
        try:
            with again.signed_in() as browser:
                for number in (last["runs"] + 1, last["runs"] + 2):
                    assert submit(browser) == f"R-{number:04d}"
                    browser.post(f"/api/v1/runs/R-{number:04d}/cancel")
            new = given(again)
        finally:
            again.stop()
        assert {name: new[name] - last[name] for name in numbers.TABLES} == {
            "runs": 5, "sweeps": 1, "signoffs": 1, "requirement_files": 1, "drafts": 1,
        }  # fmt: skip
        last = new


def damaged(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[4096 : 4096 * 3] = b"\xff" * 4096 * 2
    file.write_bytes(bytes(content))


@pytest.mark.parametrize("spoil", [damaged, Path.unlink, lambda file: file.write_bytes(b"")])
def test_where_the_former_database_cannot_be_read_it_is_stated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], spoil: Callable[[Path], object]
) -> None:
    data = tmp_path / "data"
    backup(migrated(data), tmp_path / "backup")
    spoil(data / "clearance.sqlite3")
    assert invoke(["restore", str(tmp_path / "backup"), "--yes", "--data", str(data)]) == 0
    assert "given again" in capsys.readouterr().out


def test_a_backup_with_higher_numbers_than_the_former_database_continues_above_its_own(tmp_path: Path) -> None:
    first, second = migrated(tmp_path / "first"), migrated(tmp_path / "second")
    file = tmp_path / "backup"
    with connected(first) as engine, engine.begin() as writer:
        assert numbers.continue_above(writer, {"runs": 7, "drafts": 3}) is not None
    backup(first, file)
    found = restore(second, file).numbers
    assert found == {"runs": 7, "sweeps": 0, "signoffs": 0, "requirement_files": 0, "drafts": 3}
    with closing(sqlite3.connect(tmp_path / "second" / "clearance.sqlite3")) as connection:
        assert numbers.of_file(connection) == found


def test_every_table_that_counts_is_continued_or_known_not_to_be() -> None:
    counted = {
        table.name
        for table in Base.metadata.tables.values()
        if table.autoincrement_column is not None and table.autoincrement_column.autoincrement is True
    }
    assert counted - set(numbers.TABLES) == {"audit", "tokens"}, "consecutive rows; tokens have names"
