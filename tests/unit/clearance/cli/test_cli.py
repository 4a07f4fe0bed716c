"""The command line without any service: exit codes, tokens, login links."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from backend.db import access
from backend.db.access import hashed
from backend.db.engine import connect, default_url, read
from backend.db.tables import LoginLink, Token
from campaigns.refusals import RefusalCode
from clearance.cli import INTERNAL, INTERRUPTED, WRONG_INPUT, build, invoke
from tests.given.refused_commands import refused


@pytest.mark.parametrize(
    ("arguments", "statement"),
    [
        ([], ""),
        (["bogus"], "No such command 'bogus'"),
        (["run"], "give a campaign file, the name of one in the library, or --continue RUN"),
        (["run", "--bogus"], "No such option: --bogus"),
        (["serve", "--port", "70000"], "--port"),
        (["token"], ""),
        (["token", "create"], "Missing argument"),
        (["token", "list", "--database", "mysql://x"], "sqlite:///FILE or postgresql://..."),
        (["worker", "--database", "nonsense"], "database"),
        (["worker", "--database", "sqlite://"], "sqlite:///path/to/file"),
    ],
)
def test_wrong_usage_exits_with_3_and_names_the_mistake(
    arguments: list[str],
    statement: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke(arguments) == WRONG_INPUT
    assert statement in capsys.readouterr().err
    assert not list(tmp_path.iterdir()), "nothing was left behind"


def test_help_exits_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["--help"]) == 0
    shown = capsys.readouterr().out
    for command in ("run", "audit", "trail", "submit", "follow", "validate", "serve", "worker", "token", "login-link"):
        assert f" {command} " in shown


@pytest.mark.parametrize("arguments", [["audit", "--help"], ["audit", "run", "--help"], ["audit", "--bogus"]])
def test_the_usage_of_an_audit_names_the_command_that_users_type(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    invoke(arguments)
    printed = capsys.readouterr()
    assert (printed.out + printed.err).split()[1:4] == ["clearance", "audit", "[OPTIONS]"]


@pytest.mark.parametrize(
    ("raised", "code", "statement"),
    [
        (RuntimeError("a bug"), INTERNAL, "Internal error in Clearance; this is not a result of your campaign."),
        (KeyboardInterrupt(), INTERRUPTED, "interrupted"),
        (KeyboardInterrupt("nothing is stored"), INTERRUPTED, "interrupted: nothing is stored"),
    ],
)
def test_what_goes_wrong_inside(
    raised: BaseException,
    code: int,
    statement: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise raised

    token = importlib.import_module("clearance.cli.token")
    monkeypatch.setattr(access, "tokens", broken)
    monkeypatch.setattr(token, "opened", lambda *_: _Nothing())
    assert build() is not None
    assert invoke(["token", "list", "--data", "anywhere"]) == code
    assert capsys.readouterr().err.splitlines()[-1] == statement


class _Nothing:
    def __enter__(self) -> None: ...
    def __exit__(self, *_: object) -> None: ...


def test_a_token_is_shown_once_and_stored_as_its_hash(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = ["--data", str(tmp_path)]
    assert invoke(["token", "create", "ci", *data]) == 0
    secret = capsys.readouterr().out.strip()
    assert secret.startswith("clr_")
    assert len(secret) > 40
    engine = connect(default_url(tmp_path))
    with read(engine) as connection:
        [row] = connection.execute(Token.__table__.select()).all()
    assert (row.name, row.hash, row.revoked) == ("ci", hashed(secret), None)
    assert secret.encode() not in b"".join(file.read_bytes() for file in tmp_path.iterdir())

    assert refused(capsys, "token", "create", "ci", *data) == RefusalCode.NAME_TAKEN
    assert invoke(["token", "revoke", "ci", *data]) == 0
    assert invoke(["token", "list", *data]) == 0
    *_, line = capsys.readouterr().out.splitlines()
    assert line.split()[0] == "ci"
    assert line.split()[-1] != "-", "it is shown as revoked"
    assert invoke(["token", "revoke", "other", *data]) == WRONG_INPUT
    engine.dispose()


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("first", "second"), [("ci", "CI"), ("ÉH", "ÉH"), ("ÉH", "éh"), ("Ж", "ж")])
def test_names_of_tokens_differ_by_more_than_case_in_every_script(
    first: str, second: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = ["--data", str(tmp_path)]
    assert invoke(["token", "create", first, *data]) == 0
    assert refused(capsys, "token", "create", second, *data) == RefusalCode.NAME_TAKEN


def test_a_login_link_for_the_service_of_that_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = ["--data", str(tmp_path)]
    assert refused(capsys, "login-link", *data) == RefusalCode.NO_DATABASE
    invoke(["token", "create", "ci", *data])
    (tmp_path / "service-address").write_text("http://127.0.0.1:8123\n")
    capsys.readouterr()
    for options, address in (([], "http://127.0.0.1:8123"), (["--url", "https://a.example/"], "https://a.example")):
        assert invoke(["login-link", *data, *options]) == 0
        link = capsys.readouterr().out.strip()
        assert link.startswith(f"{address}/login?code=")
        engine = connect(default_url(tmp_path))
        with read(engine) as connection:
            known = {row.hash for row in connection.execute(LoginLink.__table__.select())}
        engine.dispose()
        assert hashed(link.partition("=")[2]) in known


def test_no_worker_is_alive_without_heartbeats(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    invoke(["token", "create", "ci", "--data", str(tmp_path)])
    assert invoke(["worker", "--check", "--data", str(tmp_path)]) == 1


@pytest.mark.parametrize("words", [["worker", "--check"], ["restore", "{folder}/no-backup", "--yes"]])
def test_what_only_looks_or_refuses_makes_no_database(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "no-backup").write_text("hello", encoding="utf-8")
    given = [word.format(folder=tmp_path) for word in words]
    assert invoke([*given, "--data", str(tmp_path / "data")]) == WRONG_INPUT
    assert not (tmp_path / "data" / "clearance.sqlite3").exists()


@pytest.mark.parametrize(
    "words",
    [
        ["reproduce", "--steps", "--table", "5.3"],
        ["reproduce", "--steps", "--out", "x"],
        ["submit", "unicycle_static", "--no-wait", "--json"],
        ["submit", "unicycle_static", "--no-wait", "--out", "x"],
        ["propose", "--cost", "1", "--parameters", "65"],
    ],
)
def test_options_without_effect_are_refused(words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CLEARANCE_TOKEN", "x")
    assert invoke(words) == WRONG_INPUT
    assert list(tmp_path.iterdir()) == []


def test_an_exported_trail_without_rows_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "trail").touch()
    assert refused(capsys, "trail", "verify", "--file", tmp_path / "trail") == RefusalCode.NO_TRAIL
