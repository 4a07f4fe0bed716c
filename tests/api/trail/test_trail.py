"""The audit trail over HTTP and on the command line: pages, filters, export, and that its chain is verified."""

from __future__ import annotations

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from backend.db import audit
from backend.db.access import Visitor
from backend.db.chain import digest
from backend.db.engine import read
from campaigns.refusals import RefusalCode
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from tests.api.conftest import Fresh, running
from tests.given.chain_faults import rows_of
from tests.given.databases import BOTH
from tests.given.problem_documents import problem
from tests.given.refused_commands import refused
from tests.given.service import Service
from tests.given.submissions import submit

AUDIT = "/api/v1/audit"
RENAMED = "Note: `clearance audit head` is now `clearance trail head`; the next version removes the earlier name.\n"
ADA = Visitor("ada", "password", account="ada", role="admin")


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service in whose trail are a launch by a token and 300 edits; the tests only add to it."""
    with running(fresh_sqlite, tmp_path_factory.mktemp("trail")) as service:
        service.publish()
        with service.visitor(authorization=f"Bearer {service.token('nightly')}") as program:
            submit(program)
        with service.engine.begin() as writer:
            for i in range(300):
                audit.note(writer, ADA, "run.edited", "R-0001", {"number": i})
        yield service


@pytest.fixture(scope="module")
def admin(service: Service) -> Iterator[httpx.Client]:
    with service.signed_in() as client:
        yield client


def test_it_is_read_in_pages_newest_first_and_completely(service: Service, admin: httpx.Client) -> None:
    found, cursor = [], None
    while True:
        page = admin.get(AUDIT, params={"limit": 70, **({"cursor": cursor} if cursor else {})}).json()
        found += [item["id"] for item in page["items"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    with read(service.engine) as reader:
        assert found == [row["id"] for row in audit.rows(reader)][::-1]
        assert page["head"] == str(audit.head(reader))
    assert page["total"] == len(found)
    assert {"run.submitted", "run.edited", "session.opened"} <= set(page["actions"])
    assert {"ada", "nightly", "local"} <= set(page["actors"])


def test_the_filters_find_users_with_their_tokens_and_actions_with_their_family(admin: httpx.Client) -> None:
    def found(**params: str) -> set[tuple[str, str]]:
        return {(item["user"], item["action"]) for item in admin.get(AUDIT, params=params).json()["items"]}

    assert ("nightly", "run.submitted") in found(actor="local"), "the token's owner"
    assert found(actor="nightly") == {("nightly", "run.submitted")}
    assert found(action="run.submitted") == {("nightly", "run.submitted")}
    assert {action for _, action in found(action="session")} == {"session.opened"}
    assert found(action="run%") == set()
    assert found(actor="nobody") == set()


@pytest.mark.parametrize("cursor", ["x", "-1", "1.5", "²", "9" * 30])
def test_a_wrong_cursor_is_refused(admin: httpx.Client, cursor: str) -> None:
    problem(admin.get(AUDIT, params={"cursor": cursor}), 422)


def test_the_export_has_every_row_and_is_verified_as_a_file(
    service: Service, admin: httpx.Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answer = admin.get(f"{AUDIT}/export")
    assert answer.headers["content-type"].startswith("application/jsonl")
    rows = [json.loads(line) for line in answer.text.splitlines()]
    assert [row["id"] for row in rows] == list(range(1, len(rows) + 1))
    assert (rows[-1]["action"], rows[-1]["detail"]) == ("audit.exported", {"rows": len(rows) - 1})
    assert all(digest(row) == row["hash"] for row in rows)
    file = tmp_path / "audit.jsonl"
    file.write_text(answer.text)
    head = f"{rows[-1]['id']}:{rows[-1]['hash']}"
    assert invoke(["trail", "verify", "--file", str(file), "--head", head]) == 0
    assert f"Head: {head}" in capsys.readouterr().out
    file.write_text("".join(answer.text.splitlines(keepends=True)[:-1]))
    assert invoke(["trail", "verify", "--file", str(file)]) == 0
    assert "noted elsewhere" in capsys.readouterr().out, "it says what it cannot show"
    assert invoke(["trail", "verify", "--file", str(file), "--head", head]) == VIOLATED
    assert rows_of(capsys.readouterr().out.splitlines()) == [[rows[-1]["id"], rows[-2]["id"]]]
    file.write_text(answer.text.replace('"number":17}', '"number":71}', 1))
    assert invoke(["trail", "verify", "--file", str(file)]) == VIOLATED
    assert "was changed" in capsys.readouterr().out


@pytest.mark.parametrize("text", ["x\n", "{}\n", "[1]\n", '{"id": "1"}\n', "\n"])
def test_a_file_that_is_no_trail_is_refused(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x").write_text(text)
    assert refused(capsys, "trail", "verify", "--file", tmp_path / "x") == RefusalCode.NO_TRAIL


@BOTH
def test_rows_cannot_be_changed_and_changes_past_that_are_found(bare: Service) -> None:
    with bare.engine.begin() as writer:
        for i in range(6):
            audit.note(writer, ADA, "run.edited", "R-0001", {"number": i, "margin": -0.1 * i, "é": None})
    for change in ("update audit set subject = 'R-0002' where id = 3", "delete from audit where id = 3"):
        with pytest.raises(sa.exc.DBAPIError, match="append-only"), bare.engine.begin() as writer:
            writer.exec_driver_sql(change)
    with bare.engine.begin() as writer:
        for lift in unlocked(bare):
            writer.exec_driver_sql(lift)
        assert audit.verified(writer).faults == []
        writer.exec_driver_sql("update audit set subject = 'R-0002' where id = 3")
        assert rows_of(audit.verified(writer).faults) == [[3]]
        writer.exec_driver_sql("update audit set subject = 'R-0001' where id = 3")
        writer.exec_driver_sql("delete from audit where id = 4")
        assert rows_of(audit.verified(writer).faults) == [[4, 5]]
        writer.exec_driver_sql("delete from audit where id in (5, 6)")
        assert rows_of(audit.verified(writer).faults) == [[3, 6, 3]], "three are missing, the head, the last"


def unlocked(service: Service) -> list[str]:
    """What whoever owns the database can do."""
    if service.engine.dialect.name == "sqlite":
        return ["drop trigger audit_no_update", "drop trigger audit_no_delete"]
    return ["drop trigger audit_fixed on audit"]


@BOTH
def test_writers_at_the_same_time_make_one_chain(bare: Service) -> None:
    def write(number: int) -> None:
        with bare.engine.begin() as writer:
            audit.note(writer, ADA, "run.edited", f"R-{number:04}", {})

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, range(40)))
    with read(bare.engine) as reader:
        assert audit.verified(reader).faults == []
        assert [row["id"] for row in audit.rows(reader)] == list(range(1, 41))


def test_a_request_that_fails_leaves_no_row_and_no_gap(bare: Service) -> None:
    with bare.engine.begin() as writer:
        audit.note(writer, ADA, "run.edited", "R-0001", {})
    with bare.engine.connect() as writer:
        audit.note(writer, ADA, "run.edited", "R-0002", {})
        writer.rollback()
    with bare.engine.begin() as writer:
        audit.note(writer, ADA, "run.edited", "R-0003", {})
        assert audit.verified(writer).faults == []
        assert [row["subject"] for row in audit.rows(writer)] == ["R-0001", "R-0003"]


def test_the_command_line_verifies_and_prints_the_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = ["--data", str(tmp_path)]
    assert refused(capsys, "trail", "verify", *data) == RefusalCode.NO_DATABASE
    assert invoke(["token", "create", "ci", "--scope", "read", "--days", "30", *data]) == 0
    assert invoke(["token", "revoke", "ci", *data]) == 0
    capsys.readouterr()
    assert invoke(["trail", "head", *data]) == 0
    head = capsys.readouterr().out.strip()
    assert head.startswith("2:")
    assert invoke(["audit", "head", *data]) == 0, "the earlier name, for one version"
    assert capsys.readouterr() == (f"{head}\n", RENAMED)
    assert invoke(["trail", "verify", "--head", head, *data]) == 0
    assert invoke(["login-link", *data]) == 0
    assert invoke(["trail", "verify", "--head", head, *data]) == 0, "later rows do not concern a noted head"
    capsys.readouterr()
    assert invoke(["trail", "verify", "--head", f"2:{'0' * 64}", *data]) == VIOLATED
    assert rows_of(capsys.readouterr().out.splitlines()) == [[2]]
    assert invoke(["trail", "verify", "--head", "nonsense", *data]) == WRONG_INPUT


def test_a_line_that_is_nested_too_deeply_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x").write_text("[" * 200_000)
    assert invoke(["trail", "verify", "--file", str(tmp_path / "x")]) == WRONG_INPUT
    assert "line 1" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        ("detail = 'not JSON'", "Row 2 was changed"),
        ("detail = '[' || replace(hex(zeroblob(60000)), '0', '[')", "Row 2 was changed"),
        ("detail = '{\"number\": NaN}'", "Row 2 was changed"),
        ("at = 'yesterday'", "Row 2 was changed"),
        ("at = 9e999", "Row 2 was changed"),
        ("user = x'ff'", "Row 2 was changed"),
        ("user = cast(x'ff' as text)", "The trail cannot be read to its end"),
        ("id = 7", "Row 7 was changed"),
    ],
)
def test_strange_values_are_found_and_the_rest_is_read(
    bare: Service, change: str, statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with bare.engine.begin() as writer:
        for i in range(2):
            audit.note(writer, ADA, "run.edited", "R-0001", {"number": i})
        for lift in unlocked(bare):
            writer.exec_driver_sql(lift)
        writer.exec_driver_sql(f"update audit set {change} where id = 2")
    assert invoke(["trail", "verify", "--data", str(bare.settings.data)]) == VIOLATED
    assert statement in capsys.readouterr().out
    if "JSON" in change:
        with bare.signed_in() as admin:
            assert admin.get(AUDIT).json()["items"][-2]["detail"] == {"unreadable": "not JSON"}


def test_a_slow_reader_of_an_export_holds_no_connection(service: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    """A snapshot that is held would keep SQLite's log from being reset while it is read."""
    monkeypatch.setattr(audit, "PAGE", 50)
    with read(service.engine) as reader:
        until = audit.head(reader).row
    reading = audit.all_rows(service.engine, until)
    found = [next(reading)["id"] for _ in range(10)]
    assert service.engine.pool.checkedout() == 0
    found += [row["id"] for row in reading]
    assert found == list(range(1, until + 1))
