"""A service is found from any folder while it runs, by the file that it locks; `clearance login-link` says which."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from backend.db.engine import connect, default_url, read
from backend.db.registry import Running, folder, registered, services
from backend.db.tables import LoginLink
from clearance.cli import WRONG_INPUT, invoke
from tests.migrated import migrated


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user without services, in a folder without a database."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("CLEARANCE_DATA", raising=False)
    monkeypatch.delenv("CLEARANCE_DATABASE", raising=False)
    (tmp_path / "somewhere").mkdir()
    monkeypatch.chdir(tmp_path / "somewhere")
    return tmp_path


def served(data: Path) -> str:
    url = migrated(data)
    (data / "service-address").write_text("http://127.0.0.1:8123\n")
    return url


def test_a_login_link_from_any_folder(elsewhere: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = elsewhere / "its data"
    database = served(data)
    with registered(data, database, "http://127.0.0.1:8123"):
        assert invoke(["login-link"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("http://127.0.0.1:8123/login?code=")
    assert str(data) in told.err
    engine = connect(database)
    with read(engine) as connection:
        assert len(connection.execute(LoginLink.__table__.select()).all()) == 1
    engine.dispose()
    assert invoke(["login-link"]) == WRONG_INPUT, "it has stopped"
    told = capsys.readouterr()
    assert (told.out, str(folder()) in told.err, str(Path.cwd() / "data") in told.err) == ("", True, True)


def test_of_several_services_one_has_to_be_named(elsewhere: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = elsewhere / "one", elsewhere / "other"
    with registered(one, served(one), "http://127.0.0.1:1"):
        with folder().joinpath("999999.json").open("w") as entry:
            entry.write('{"data": "/gone", "address": "", "usual": true}')
        assert [service.data for service in services()] == [str(one)], "a file without a lock is left over"
        # Another process would have its own file; this one has a second under another name.
        (folder() / f"{os.getpid()}.json").rename(folder() / "1.json")
        with registered(other, served(other), "http://127.0.0.1:2"):
            assert invoke(["login-link"]) == WRONG_INPUT
            told = capsys.readouterr().err
            assert f"--data {one}" in told
            assert f"--data {other}" in told
            os.chdir(elsewhere)
            (elsewhere / "one").rename(elsewhere / "data")
            assert invoke(["login-link", "--data", "data"]) == 0


def test_no_password_of_a_database_is_stored(elsewhere: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with registered(elsewhere / "data", "postgresql://ada:secret@db/clearance", "http://127.0.0.1:8123"):
        (file,) = folder().glob("*.json")
        assert "secret" not in file.read_text()
        assert file.stat().st_mode & 0o077 == 0
        assert services() == [Running(str(elsewhere / "data"), "http://127.0.0.1:8123", False)]
        assert invoke(["login-link"]) == WRONG_INPUT
    assert "--database" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["", "[]", '{"data": 1}', '{"other": true}', "\x00"])
def test_a_file_that_cannot_be_read_is_no_service(elsewhere: Path, text: str) -> None:
    folder().mkdir(parents=True)
    (folder() / "7.json").write_text(text)
    assert services() == []


def test_a_service_runs_where_it_cannot_register(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (elsewhere / "file").write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(elsewhere / "file"))
    with registered(elsewhere, default_url(elsewhere), "http://127.0.0.1:8123"):
        assert services() == []


def test_a_token_is_made_for_the_service_that_runs_and_never_a_database_for_it(
    elsewhere: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["token", "create", "ci"]) == WRONG_INPUT, "there is neither a service nor a database"
    data = elsewhere / "its data"
    database = served(data)
    with registered(data, database, "http://127.0.0.1:8123"):
        assert invoke(["token", "create", "ci"]) == 0
        assert invoke(["token", "list"]) == 0
        assert "ci " in capsys.readouterr().out
        assert invoke(["token", "revoke", "ci"]) == 0
    assert not Path("data").exists()
    here = Path("data").absolute()
    with registered(here, database, "http://127.0.0.1:8124"):  # it uses a database elsewhere
        assert invoke(["token", "create", "ci"]) == WRONG_INPUT
    assert not Path("data", "clearance.sqlite3").exists()
    assert invoke(["token", "create", "ci", "--data", str(elsewhere / "first")]) == 0, "before its first start"
