"""A database that is away, gone, damaged or read-only: 503 with a sentence on every route, and well again by itself."""

from __future__ import annotations

import shutil
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import beside, damage
from backend.db.alone import alone
from backend.db.beside import SENTENCE
from backend.db.engine import connect, default_url, migrate
from backend.db.outages import DatabaseOutage, worded
from backend.db.revision import newest
from clearance.cli import INTERNAL, WRONG_INPUT, invoke
from tests.given.outages import checkpoint, every_route_is_away, moved, torn
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit


def file_of(service: Service) -> Path:
    return Path(str(service.engine.url.database))


def test_a_deleted_file_is_noticed_on_every_route_and_not_made_again(service: Service, client: httpx.Client) -> None:
    file = file_of(service)
    with moved(file):
        every_route_is_away(client, "database-gone")
        page = client.get("/runs", headers={"Accept": "text/html"})
        assert page.status_code == 503
        assert page.headers["content-type"].startswith("text/html")
        assert "deleted" in page.text
        assert not file.exists()
    assert client.get("/api/v1/runs").status_code == 200, "it is there again"


def test_a_deleted_folder_takes_nothing_more(service: Service, client: httpx.Client) -> None:
    folder = file_of(service).parent
    submit(client)
    shutil.rmtree(folder)
    answer = client.post("/api/v1/runs", json={"campaign": {}})
    problem(answer, 503, "database-gone")
    problem(client.get("/api/v1/health"), 503, "database-gone")


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "endings", [("-wal",), pytest.param(("-shm",), marks=pytest.mark.nightly), ("-wal", "-shm")], ids=" ".join
)
def test_deleted_files_beside_the_database_are_noticed_at_once_and_lose_nothing(
    endings: tuple[str, ...], service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was stored before is there after a restart, as nothing is written in between."""
    file = file_of(service)
    runs = [submit(client, seed=seed) for seed in (1, 2)]
    for ending in endings:
        one = file.with_name(file.name + ending)
        assert one.exists()
        one.unlink()
    every_route_is_away(client, "database-gone")
    answer = client.get("/api/v1/runs")
    assert str(problem(answer, 503, "database-gone")["detail"]) == SENTENCE
    assert not any(file.with_name(file.name + ending).exists() for ending in endings), "none is made beside the others"
    service.stop()
    assert damage.damage(file) == ""
    monkeypatch.setattr(beside, "_lost", {})  # another process
    again = Service(service.settings)
    again.start()
    try:
        with again.signed_in() as later:
            assert [item["id"] for item in later.get("/api/v1/runs").json()["items"]] == runs[::-1]
            assert submit(later, seed=3) == "R-0003"
    finally:
        again.stop()


@pytest.mark.nightly
def test_connections_that_others_open_meanwhile_disturb_no_transaction(service: Service) -> None:
    """The files of all of them are looked at when a transaction begins."""
    file, over = file_of(service), threading.Event()

    def others() -> None:
        while not over.is_set():
            engine = connect(service.settings.database_url)
            with ExitStack() as stack:
                for _ in range(8):
                    stack.enter_context(engine.connect())
            engine.dispose()

    def looking() -> None:
        while not over.is_set():
            beside.refuse_deleted(file)

    with ThreadPoolExecutor(4) as pool:
        found = [pool.submit(work) for work in (others, others, looking, looking)]
        over.wait(1.0)
        over.set()
    assert [one.exception() for one in found] == [None] * 4


def test_a_file_that_was_replaced_is_opened_again(service: Service, client: httpx.Client) -> None:
    submit(client)
    file = file_of(service)
    checkpoint(service.engine)
    copy = file.with_suffix(".copy")
    shutil.copyfile(file, copy)
    submit(client, seed=2)
    assert len(client.get("/api/v1/runs").json()["items"]) == 2
    copy.replace(file)
    for ending in ("-wal", "-shm"):
        file.with_name(file.name + ending).unlink(missing_ok=True)
    assert len(client.get("/api/v1/runs").json()["items"]) == 1


def test_a_handle_that_became_read_only_is_dropped(service: Service, client: httpx.Client) -> None:
    with service.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA query_only=ON")
    answer = client.post("/api/v1/drafts", json={"name": "", "text": "name:"})
    assert "read-only" in str(problem(answer, 503, "database-away")["detail"])
    assert client.post("/api/v1/drafts", json={"name": "", "text": "name:"}).status_code == 201


def test_a_torn_page_is_damage_and_the_service_is_not_healthy(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert client.get("/api/v1/health").status_code == 200
    with torn(service.engine, "drafts"):
        answer = client.get("/api/v1/drafts")
        problem(answer, 503, "damaged")
        assert int(answer.headers["Retry-After"]) > 0
        problem(client.get("/api/v1/health"), 503, "damaged")
    monkeypatch.setattr(damage, "PERIOD", 0.0)
    assert client.get("/api/v1/health").status_code == 200, "it was read again"


def test_what_is_stored_of_an_error_has_no_statement_and_no_value(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/a.sqlite3"
    migrate(url)
    engine = connect(url)
    statements = ("insert into drafts (name) values (:x)", "select * from drafts where name = :x and foo = 1")
    for statement in statements:
        with pytest.raises(sa.exc.SQLAlchemyError) as caught, engine.begin() as connection:
            connection.execute(sa.text(statement), {"x": "secret"})
        text = worded(caught.value)
        assert text
        assert not any(word in text for word in ("secret", "insert", "select", "[SQL", "sqlalche.me")), text
    engine.dispose()
    Path(engine.url.database or "").unlink()
    with pytest.raises(DatabaseOutage) as gone, engine.begin() as connection:
        connection.execute(sa.text("select 1"))
    assert gone.value.kind == "database-gone"


def _garbage(file: Path) -> None:
    file.write_bytes(b"no database at all " * 100)


def _newer(file: Path) -> None:
    url = f"sqlite:///{file}"
    migrate(url)
    engine = connect(url)
    with engine.begin() as connection:
        connection.execute(sa.text("update alembic_version set version_num = '9999'"))
    engine.dispose()


STARTS: dict[str, tuple[Any, int, str]] = {
    "garbage": (_garbage, INTERNAL, "the database is damaged"),
    "newer": (_newer, WRONG_INPUT, f"has schema 9999, and this version of Clearance knows {newest()}"),
}


@pytest.mark.by_day(2)
@pytest.mark.parametrize("what", STARTS)
@pytest.mark.parametrize("command", ["serve", "worker", "backend"])
def test_a_database_that_cannot_be_used_is_said_at_the_start(
    what: str, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from backend.__main__ import main

    make, code, sentence = STARTS[what]
    tmp_path.chmod(0o700)
    make(tmp_path / "clearance.sqlite3")
    if command == "backend":
        monkeypatch.setenv("CLEARANCE_DATA", str(tmp_path))
        monkeypatch.setenv("CLEARANCE_PORT", "0")
        assert main() == 2
    else:
        port = ["--port", "0"] if command == "serve" else []
        assert invoke([command, "--data", str(tmp_path), *port]) == code
    said = capsys.readouterr().err
    assert sentence in said
    assert "Traceback" not in said
    assert len(said.splitlines()) == 1


def test_a_worker_with_a_wrong_address_ends(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["worker", "--data", str(tmp_path), "--database", "postgres//x"]) == WRONG_INPUT
    assert "postgresql://" in capsys.readouterr().err


def test_a_second_service_on_the_same_folder_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from backend.__main__ import main

    tmp_path.chmod(0o700)
    monkeypatch.setenv("CLEARANCE_DATA", str(tmp_path))
    monkeypatch.setenv("CLEARANCE_PORT", "0")
    with alone(tmp_path, default_url(tmp_path), "backend.lock"):
        assert main() == 2
        assert invoke(["serve", "--data", str(tmp_path), "--port", "0"]) == WRONG_INPUT
    said = capsys.readouterr().err
    assert said.count("(process ") == 2


@pytest.mark.parametrize("linked", [False, True])
def test_a_service_with_another_folder_is_refused_on_the_same_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, linked: bool
) -> None:
    """And so is a restore, with or without a data folder."""
    from backend.__main__ import main

    one, other = (tmp_path / name for name in ("one", "other"))
    for folder in (one, other):
        folder.mkdir(mode=0o700)
    url = file = default_url(one)
    if linked:
        (tmp_path / "link").symlink_to(one)
        file = default_url(tmp_path / "link")
    connect(url).dispose()
    (backup := tmp_path / "backup").touch()
    monkeypatch.setenv("CLEARANCE_DATA", str(other))
    monkeypatch.setenv("CLEARANCE_DATABASE", file)
    monkeypatch.setenv("CLEARANCE_PORT", "0")
    with alone(one, url, "backend.lock"):
        assert main() == 2
        assert invoke(["serve", "--data", str(other), "--database", file, "--port", "0"]) == WRONG_INPUT
        for data in (other, tmp_path / "none"):
            saved = ["restore", str(backup), "--yes", "--data", str(data), "--database", file]
            assert invoke(saved) == WRONG_INPUT
    said = capsys.readouterr().err
    assert said.count(str(one / "clearance.sqlite3")) == 4
    with alone(other, default_url(other), "backend.lock"), alone(one, file, "backend.lock"):
        pass  # another file is another service
