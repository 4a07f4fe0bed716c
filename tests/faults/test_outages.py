"""A database server that goes away, a damaged file, a read-only one: runs lose no attempt, nothing waits in silence."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import queue as queues
from backend.db.engine import CLIENT_LIMITS, connect, migrate, read
from backend.db.outages import DatabaseOutage
from backend.db.queue import Queue, submit
from backend.db.tables import Run
from backend.db.tables import Worker as WorkerRow
from backend.settings import Settings
from campaigns.runs import run_name
from tests.faults import postgres
from tests.faults.cases import campaign
from tests.faults.long import case
from tests.faults.processes import CLEARANCE, REPOSITORY, Started, kill, started, until, worker
from tests.faults.stored import Stored
from tests.given.outages import every_route_is_away, torn
from tests.given.problem_documents import problem
from tests.given.service import Service


@pytest.fixture(scope="module")
def server() -> Iterator[postgres.Server]:
    """A server of this file alone: others empty the tables of theirs."""
    with postgres.server() as running:
        yield running


class Bench(Stored):
    def __init__(self, url: str) -> None:
        self.engine = connect(url)

    def submit(self, name: str) -> int:
        with self.engine.begin() as connection:
            return submit(connection, campaign(name=name), name=name, tags=[], owner="", planned=0)

    def beat(self) -> float:
        """The newest heartbeat of a worker."""
        with read(self.engine) as connection:
            return connection.scalar(sa.select(sa.func.max(WorkerRow.beat))) or 0.0


@contextmanager
def benched(url: str) -> Iterator[Bench]:
    migrate(url)
    bench = Bench(url)
    try:
        yield bench
    finally:
        bench.engine.dispose()


@pytest.fixture(scope="module")
def working(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Bench, Started]]:
    """A database in a file, and a worker on it that logs as JSON."""
    folder = tmp_path_factory.mktemp("working")
    url = f"sqlite:///{folder}/clearance.sqlite3"
    with benched(url) as bench, worker(url, folder, "own", *OPTIONS, CLEARANCE_LOG="json") as running:
        yield bench, running


LIVE, READY = "/api/v1/health/live", "/api/v1/health/ready"
OPTIONS = ("--runner", "tests.faults.jobs:execute", "--lease", "2")


@pytest.mark.nightly
def test_the_service_without_its_server_and_with_it_again(server: postgres.Server, tmp_path: Path) -> None:
    migrate(server.url)
    (tmp_path / "data").mkdir()
    service = Service(Settings(data=tmp_path / "data", database=server.url, pages=tmp_path / "dist"))
    service.start()
    try:
        with service.signed_in() as client:
            server.stop()
            try:
                every_route_is_away(client, "database-away")
                with httpx.Client(base_url=service.url, trust_env=False) as stranger:
                    problem(stranger.get("/api/v1/health"), 503, "database-away")
            finally:
                server.start()
            assert client.get("/api/v1/health").status_code == 200
            assert client.get("/api/v1/runs").status_code == 200
    finally:
        service.stop()


def answered(port: int, path: str) -> tuple[int, Any]:
    """The status and the document of an answer; 0 if there is none."""
    try:
        answer = httpx.get(f"http://127.0.0.1:{port}{path}", timeout=10, trust_env=False)
    except httpx.TransportError:
        return 0, None
    return answer.status_code, answer.json() if "json" in answer.headers["content-type"] else answer.text


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


@pytest.mark.nightly
def test_a_service_that_starts_before_its_server_is_alive_and_waits(server: postgres.Server, tmp_path: Path) -> None:
    """And stops at a signal meanwhile; one line a minute, no traceback, no address of the database in an answer."""
    port = free_port()
    settings = {"CLEARANCE_DATABASE": server.url, "CLEARANCE_DATA": str(tmp_path / "data"), "CLEARANCE_PORT": str(port)}
    backend = [sys.executable, "-P", "-m", "backend"]
    server.stop()
    try:
        with started(backend, tmp_path, "stopped", **settings) as stopped:
            until(lambda: answered(port, LIVE)[0] == 200, stopped.text())
            kill(stopped.pid, number=signal.SIGTERM)
            assert stopped.process.wait(30) == 0, stopped.text()
        with started(backend, tmp_path, "waiting", **settings) as waiting:
            until(lambda: answered(port, LIVE)[0] == 200, waiting.text())
            status, document = answered(port, READY)
            assert (status, [error["field"] for error in document["errors"]]) == (503, ["database-away"])
            assert [answered(port, path)[0] for path in ("/health/live", "/health/ready")] == [200, 503]
            for path in ("/api/v1/health", "/api/v1/runs", "/metrics", "/api/v1/nowhere"):
                status, document = answered(port, path)
                assert (status, document["type"].rpartition(":")[2]) == (503, "database-away"), path
                assert "host" not in str(document)
            assert answered(port, "/api/v1/view/x")[0] == 503
            server.start()
            until(lambda: answered(port, "/api/v1/health")[0] == 200, waiting.text())
            assert [error["field"] for error in answered(port, READY)[1]["errors"]] == ["workers"]
            assert waiting.text().count("for the database:") == 1
            assert "Traceback" not in waiting.text()
            until(waiting.link, waiting.text())
            assert httpx.get(waiting.link(), trust_env=False).status_code == 303
            kill(waiting.pid, number=signal.SIGTERM)
            assert waiting.process.wait(30) == 0, waiting.text()
    finally:
        server.start()


@pytest.mark.nightly  # by day the service and the worker that it starts do, each by itself
def test_serve_waits_for_its_server(server: postgres.Server, tmp_path: Path) -> None:
    server.stop()
    words = [*CLEARANCE, "serve", "--data", str(tmp_path / "data"), "--port", "0"]
    try:
        with started(words, tmp_path, "serve", CLEARANCE_DATABASE=server.url, CLEARANCE_THREADS="1") as running:
            until(lambda: "waiting for the database" in running.text(), "it says that it waits")
            log = tmp_path / "data" / "logs" / "worker-1.log"
            until(lambda: log.exists() and "waiting for the database" in log.read_text(), "its worker waits as well")
            assert running.process.poll() is None
            server.start()
            until(lambda: "Clearance is ready" in running.text(), running.text(), 120)
            assert "could not start" not in running.text()
            assert "restarting" not in running.text()
    finally:
        server.start()


def test_a_worker_waits_for_its_server_and_a_run_survives_its_loss(server: postgres.Server, tmp_path: Path) -> None:
    with benched(server.url) as bench:
        server.stop()
        try:
            with worker(server.url, tmp_path, "waiting", *OPTIONS) as running:
                until(lambda: "waiting for the database" in running.text(), "it says that it waits")
                assert running.process.poll() is None
                server.start()
                run_id = bench.submit("linger")
                until(lambda: bench.run(run_id).evaluations > 0, "under way")
                server.stop()
                until(lambda: "cannot be reached" in running.text(), "the loss is noticed")
                server.start()
                ended = bench.ended(run_id)
                assert (ended.state, ended.attempts, ended.losses) == ("done", 1, 0)
        finally:
            server.start()


def test_a_process_that_is_stopped_in_a_transaction_loses_its_locks(
    server: postgres.Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else nobody could take its run, for as long as it stands still."""
    monkeypatch.setitem(CLIENT_LIMITS, "idle_in_transaction_session_timeout", 300)
    with benched(server.url) as stopped, benched(server.url) as other:
        run_id = stopped.submit("held")
        named = sa.update(Run).where(Run.id == run_id)
        with stopped.engine.connect() as connection:
            connection.execute(named.values(name="its own"))
            with other.engine.begin() as writer:
                writer.execute(sa.text("set local lock_timeout = '20s'"))
                writer.execute(named.values(name="another"))
            with pytest.raises(DatabaseOutage) as raised:
                connection.execute(sa.select(Run.name)).all()
        assert raised.value.kind == "database-away"
        with stopped.engine.begin() as again:
            assert again.scalar(sa.select(Run.name).where(Run.id == run_id)) == "another"


@pytest.mark.nightly
def test_a_worker_takes_no_run_without_space_and_says_so_once_a_minute(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/clearance.sqlite3"
    settings = {"CLEARANCE_MIN_FREE": str(10**17), "CLEARANCE_LOG": "json"}
    with benched(url) as bench, worker(url, tmp_path, "narrow", *OPTIONS, **settings) as running:
        run_id = bench.submit("none")
        until(lambda: "no further run is begun" in running.text(), "it says why")
        looked = bench.beat()
        until(lambda: bench.beat() > looked, "it goes on")
        assert (bench.run(run_id).state, bench.run(run_id).fence) == ("queued", 0)
        lines = [json.loads(line) for line in running.text().splitlines()]
    [line] = [line for line in lines if line["message"].startswith("no further run")]
    assert (line["level"], line["logger"], line["worker"]) == ("WARNING", "clearance.worker", "narrow")
    assert "CLEARANCE_MIN_FREE" in line["message"]


@pytest.mark.nightly  # by day an error of a child is one line
def test_every_line_of_a_worker_states_run_and_stage(tmp_path: Path) -> None:
    """Also those of its child, whose errors have many lines."""
    url = f"sqlite:///{tmp_path}/clearance.sqlite3"
    with benched(url) as bench, worker(url, tmp_path, "own", CLEARANCE_LOG="json") as running:
        with bench.engine.begin() as connection:
            run_id = submit(connection, case(), name="long", tags=[], owner="", planned=0)
        until(lambda: bench.run(run_id).evaluations > 2000, running.text())
        kill(running.child())
        until(lambda: "killed" in running.text(), "its loss is said")
        lines = [json.loads(line) for line in running.text().splitlines()]
        assert all(line["worker"] == "own" and line["time"] for line in lines)
        [begun] = [line for line in lines if "attempt 1" in line["message"]]
        assert (begun["run"], "stage" in begun) == ("R-0001", False)
        [lost] = [line for line in lines if "killed" in line["message"]]
        assert (lost["run"], lost["stage"].split()[0]) == ("R-0001", "search")


def without_override(*command: str) -> list[str]:
    """As a user that may not write everything, which root may."""
    if os.geteuid() != 0:
        return list(command)
    return ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all", *command]


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("command", "what"), [("serve", "file"), pytest.param("worker", "folder", marks=pytest.mark.nightly)]
)
def test_a_read_only_database_is_said_at_once(command: str, what: str, tmp_path: Path) -> None:
    data = tmp_path / "data"
    file = data / "clearance.sqlite3"
    migrate(f"sqlite:///{file}")
    data.chmod(0o700 if what == "file" else 0o500)
    file.chmod(0o400)
    port = ["--port", "0"] if command == "serve" else []
    words = without_override(sys.executable, "-m", "clearance", command, "--data", str(data), *port)
    try:
        environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False, env=environment)
    finally:
        data.chmod(0o700)
    assert done.returncode in (3, 4), done.stderr
    assert "read-only" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_clock_that_was_put_back_does_not_extend_a_lease(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(queues, "LEASE", 0.3)
    with benched(f"sqlite:///{tmp_path}/clearance.sqlite3") as bench:
        run_id = bench.submit("none")
        late, alive, other = (Queue(bench.engine, 0.3) for _ in range(3))
        at = queues.now
        monkeypatch.setattr(queues, "now", lambda connection: at(connection) + 3600.0)
        claim = late.claim("late")
        assert claim is not None
        assert claim.run_id == run_id
        monkeypatch.setattr(queues, "now", at)
        assert other.claim("other") is None, "its worker may be about to renew it"
        alive.beat(claim)
        assert other.claim("other") is None, "renewed"
        monkeypatch.setattr(queues, "now", lambda connection: at(connection) + 3600.0)
        alive.beat(claim)
        monkeypatch.setattr(queues, "now", at)
        until(lambda: other.claim("other"), "claimed by another", 10.0)
        assert bench.run(run_id).worker == "other"


def test_a_pause_does_not_last_longer_after_the_clock_was_put_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with benched(f"sqlite:///{tmp_path}/clearance.sqlite3") as bench:
        bench.submit("none")
        queue, at = Queue(bench.engine), queues.now
        monkeypatch.setattr(queues, "now", lambda connection: at(connection) + 3600.0)
        claim = queue.claim("one")
        assert claim is not None
        queue.retry(claim, "it failed")
        monkeypatch.setattr(queues, "now", at)
        assert queue.claim("one") is not None


@pytest.mark.nightly
def test_a_damaged_file_uses_up_no_attempt(working: tuple[Bench, Started]) -> None:
    bench, running = working
    until(lambda: bench.ended(bench.submit("none")), "the worker is ready")
    with torn(bench.engine, "evaluation_chunks"):
        run_id = bench.submit("none")
        until(lambda: bench.run(run_id).error is not None, running.text())
        put_off = bench.run(run_id)
    assert "damaged" in put_off.error
    assert "SQL" not in put_off.error
    assert (put_off.state, put_off.attempts, put_off.losses) == ("queued", 0, 0)
    ended = bench.ended(run_id)
    assert (ended.state, ended.attempts, ended.error) == ("done", 1, None), running.text()


@pytest.mark.nightly
def test_an_error_of_a_child_is_one_line(working: tuple[Bench, Started]) -> None:
    """Last here: its worker tries that run again, which costs another process each time."""
    bench, running = working
    before = len(running.text())
    name = run_name(bench.submit("fail"))
    until(lambda: "BrokenPipeError" in running.text()[before:], running.text())
    errors = [line for line in map(json.loads, running.text()[before:].splitlines()) if "error" in line]
    assert [(line["run"], line["worker"], line["level"]) for line in errors[:1]] == [(name, "own", "ERROR")]
    assert errors[0]["error"].endswith("no pipe")
