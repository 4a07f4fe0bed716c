"""What the service stores is closed to other users of the machine."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from backend.db.engine import connect, default_url, migrate
from backend.db.private import SharedFolderError, keep_private


@pytest.fixture(autouse=True)
def lax() -> Iterator[None]:
    """The usual umask, restored afterwards."""
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_folder_and_everything_made_in_it_are_closed(tmp_path: Path) -> None:
    data = tmp_path / "new"
    keep_private(data)
    migrate(default_url(data))
    (data / "made later").write_text("x")
    assert mode(data) == 0o700
    assert {mode(path) for path in data.iterdir()} == {0o600}


def test_an_existing_folder_is_tightened_and_the_users_own_files_stay(tmp_path: Path) -> None:
    data = tmp_path / "data"
    logs = data / "logs"
    logs.mkdir(parents=True)
    names = ["clearance.sqlite3", "clearance.sqlite3-wal", "login-link", "logs/backend.log", "logs/worker-1.old.log"]
    for name in names:
        (data / name).write_text("secret")
    (data / "campaign.yaml").write_text("the user's")
    elsewhere = tmp_path / "elsewhere.sqlite3"
    elsewhere.write_text("")
    (tmp_path / "program").write_text("")
    (data / "serve.lock").symlink_to(tmp_path / "program")
    keep_private(data, f"sqlite:///{elsewhere}")
    assert (mode(data), mode(logs), mode(elsewhere)) == (0o700, 0o700, 0o600)
    assert {name: mode(data / name) for name in names} == dict.fromkeys(names, 0o600)
    assert mode(data / "campaign.yaml") == 0o644
    assert mode(tmp_path / "program") == 0o644, "what a link points to is not ours"


def test_a_folder_of_all_users_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o1777)
    with pytest.raises(SharedFolderError, match=re.escape(str(tmp_path))):
        keep_private(tmp_path)
    assert mode(tmp_path) == 0o1777


def test_a_database_made_by_any_command_is_closed(tmp_path: Path) -> None:
    with connect(default_url(tmp_path / "made")).begin() as connection:
        connection.exec_driver_sql("create table t (x)")
        assert {mode(path) for path in (tmp_path / "made").iterdir()} == {0o600}
    assert mode(tmp_path / "made") == 0o700
