"""`clearance serve`: starts, recovers, and leaves no process behind."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
from pathlib import Path

import pytest

from backend.http.pages import unbuilt
from backend.settings import Settings
from clearance.cli import WRONG_INPUT, invoke
from tests.faults.processes import CLEARANCE, REPOSITORY, alive, kill, until
from tests.faults.serving import get, long_run, serving, state


def clearance(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*CLEARANCE, *arguments], cwd=REPOSITORY, capture_output=True, text=True, check=False)


def here(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Exit code and output of a command that ends at once, run in this process."""
    capsys.readouterr()
    umask = os.umask(0o077)
    try:
        return invoke(arguments), *capsys.readouterr()
    finally:
        os.umask(umask)


def test_serve_from_its_start_to_ctrl_c(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with serving(tmp_path, CLEARANCE_THREADS="1", CLEARANCE_MAX_VIEWER="3", CLEARANCE_PAGES=str(tmp_path)) as service:
        assert service.healthy()
        (unknown,) = Settings.unknown({"CLEARANCE_MAX_VIEWER": "3"})
        warnings = [line for line in service.text().splitlines() if line.startswith("Warning: ")]
        assert f"Warning: {unknown}" in " ".join(warnings[0].split())
        assert len(warnings) == 2, "what the processes set for each other is no unknown setting"
        assert unbuilt(tmp_path) in " ".join(service.text().split())
        assert [get(service.link()) for _ in range(2)] == [303, 403], "the link is single-use"
        stored = [path for path in service.data.rglob("*") if path.is_file()]
        assert {path.name for path in stored} >= {"clearance.sqlite3", "backend.log", "worker-1.log"}
        assert not any(b"code=" in path.read_bytes() for path in stored), "the link is on the terminal only"
        assert not any(path.stat().st_mode & 0o077 for path in [service.data, *service.data.rglob("*")])

        _, fresh, _ = here(capsys, "login-link", "--data", str(service.data))
        assert fresh.startswith(service.link().partition("=")[0])
        code, _, statement = here(capsys, "serve", "--data", str(service.data))
        assert (code, f"(process {service.pid})" in statement) == (WRONG_INPUT, True)

        engine, run_id = long_run(service.data)
        family = service.family()
        assert len(family) >= 4
        kill(service.pid, number=signal.SIGINT)
        until(lambda: not any(map(alive, family)), "nothing is left")
        assert service.process.wait() == 130
        assert service.text().endswith("Stopped.\n")
        assert (state(engine, run_id).state, state(engine, run_id).error) == ("queued", None)
        engine.dispose()


@pytest.mark.nightly
def test_what_serve_started_is_started_again(tmp_path: Path) -> None:
    with serving(tmp_path, CLEARANCE_THREADS="1") as service:
        for words, name in (("-m backend", "The backend"), ("-m clearance worker", "Worker 1")):
            old = service.part(words)
            kill(old)
            until(lambda words=words, old=old: service.part(words) not in (0, old), f"another {name}")
            until(lambda name=name: f"{name} ended with signal 9 (SIGKILL)" in service.text(), "it is reported")
        until(service.healthy, "healthy again")


@pytest.mark.parametrize("made", [True, False])
def test_a_taken_port_is_reported_and_nothing_is_made(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], made: bool
) -> None:
    data = tmp_path if made else tmp_path / "new"
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        code, _, statement = here(capsys, "serve", "--data", str(data), "--port", port)
    assert code == WRONG_INPUT
    assert f"port {port} of 127.0.0.1 " in " ".join(statement.split())
    assert made or not data.exists()


@pytest.mark.nightly  # by day the service itself refuses it, in tests/api/http/test_process.py
def test_an_address_open_to_other_machines_is_refused(tmp_path: Path) -> None:
    refused = clearance("serve", "--data", str(tmp_path), "--port", "0", "--host", "0.0.0.0", "--workers", "0")
    assert refused.returncode == 3
    assert "only the loopback address is allowed" in refused.stdout
