"""Secrets from files: one way for all of them, in the service and on the command line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.secret_settings import DATABASE, FILE, LONGEST, PASSWORD, database, with_password
from backend.settings import Settings
from clearance.cli import WRONG_INPUT, invoke

URL = "postgresql://clearance@postgres/clearance"
ODD = "a@b:c/d%e f"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "secret"
    path.write_text(f"{ODD}\n", encoding="utf-8")
    return path


def refused(**given: str) -> str:
    with pytest.raises(ValueError, match="CLEARANCE_") as error:
        Settings.load(given)
    return str(error.value)


def test_every_secret_of_the_settings_may_come_from_a_file(file: Path) -> None:
    names = Settings.secret()
    assert {DATABASE, PASSWORD, "CLEARANCE_WEBHOOK_SECRET", "CLEARANCE_OIDC_CLIENT_SECRET"} <= set(names)
    assert Settings.unknown(dict.fromkeys((name + FILE for name in names), "x")) == []
    client = Settings.load({"CLEARANCE_OIDC_CLIENT_SECRET_FILE": str(file)}).oidc_client_secret
    assert client.get_secret_value() == ODD


def test_the_password_is_put_into_the_address(file: Path) -> None:
    given = {DATABASE: URL, PASSWORD + FILE: str(file)}
    settings = Settings.load(given)
    parsed = sa.make_url(settings.database_url)
    assert (parsed.password, parsed.host, parsed.database) == (ODD, "postgres", "clearance")
    assert database(URL, given) == settings.database_url
    assert ODD not in repr(settings)
    assert settings.database_url not in repr(settings)


def test_a_whole_address_may_be_in_a_file(file: Path) -> None:
    file.write_text(f"{URL}\n")
    assert Settings.load({DATABASE + FILE: str(file)}).database_url == URL
    assert database("", {DATABASE + FILE: str(file)}) == URL
    assert database("sqlite:///other", {DATABASE + FILE: str(file)}) == "sqlite:///other", (
        "an option of the command line"
    )


@pytest.mark.parametrize("name", Settings.secret())
def test_value_and_file_together_are_refused(name: str, file: Path) -> None:
    assert f"{name} and {name}{FILE}" in refused(**{name: "x", name + FILE: str(file)})


@pytest.mark.parametrize("content", [b"", b" \n", b"\xff\xfe", b"x" * (LONGEST + 1)])
def test_a_file_that_has_no_secret_is_refused(file: Path, content: bytes) -> None:
    file.write_bytes(content)
    assert (PASSWORD + FILE) in refused(**{DATABASE: URL, PASSWORD + FILE: str(file)})


def test_a_file_that_is_missing_or_cannot_be_read_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none", tmp_path):
        sentence = refused(**{DATABASE: URL, PASSWORD + FILE: str(path)})
        assert PASSWORD + FILE in sentence
        assert str(path) in sentence


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every file")
def test_a_file_of_somebody_else_is_refused(file: Path) -> None:
    file.chmod(0)
    assert str(file) in refused(**{DATABASE: URL, PASSWORD + FILE: str(file)})


@pytest.mark.parametrize("url", ["", "sqlite:///x", "postgresql://a:b@c/d", "nonsense"])
def test_a_password_without_a_place_for_it_is_refused_without_being_shown(url: str) -> None:
    with pytest.raises(ValueError, match=PASSWORD) as error:
        with_password(url, ODD)
    assert ODD not in str(error.value)
    assert PASSWORD in refused(**{DATABASE: url, PASSWORD: ODD})


def test_the_command_line_says_what_is_wrong_with_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(DATABASE, URL)
    monkeypatch.setenv(PASSWORD + FILE, str(tmp_path / "none"))
    assert invoke(["worker", "--check", "--data", str(tmp_path)]) == WRONG_INPUT
    assert PASSWORD + FILE in capsys.readouterr().err
