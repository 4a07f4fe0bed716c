"""`clearance submit` in a CI job: its files, the baseline, a reused verdict, a job that is stopped."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
import yaml

from backend.db.baselines import none_found
from clearance.cli import INTERNAL, INTERRUPTED, VIOLATED, WRONG_INPUT, _following, invoke
from clearance.client import Client
from tests.faults.processes import CLEARANCE, REPOSITORY
from tests.given.refused_commands import fields
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

Command = Callable[..., "Future[int]"]


@pytest.fixture
def command(service: Service, monkeypatch: pytest.MonkeyPatch) -> Iterator[Command]:
    """The command line in a thread, with the service's address and a token in its environment."""
    monkeypatch.setenv("CLEARANCE_SERVICE", service.url)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    pool = ThreadPoolExecutor(1)
    yield lambda *arguments: pool.submit(invoke, [arguments[0], "--patience", "5", *map(str, arguments[1:])])
    pool.shutdown(wait=False)  # what a failed test leaves waiting ends with the service


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "campaign.yaml"
    path.write_text(yaml.safe_dump(campaign()))
    return path


def ended(service: Service, command: Command, *arguments: str, verdict: str = "cleared", run: int = 1) -> int:
    ending = command("submit", *arguments)
    until(lambda: service.rows()["runs"] == run)
    finish_fully(service, verdict)
    return ending.result(30)


def test_the_files_of_a_job(
    service: Service, command: Command, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    junit, summary = tmp_path / "reports" / "junit.xml", tmp_path / "summary.md"
    summary.write_text("# The job\n")
    options = ("--junit", str(junit), "--summary", str(summary), "--label", "branch=main", "--label", "build=7")
    baseline = ("--baseline", "label:branch=main")
    assert ended(service, command, str(file), *options, *baseline, verdict="violated") == VIOLATED
    assert none_found("label:branch=main") in capsys.readouterr().out
    suite = Xml.parse(junit).getroot()[0]
    cases = {case.get("name"): case for case in suite.iter("testcase")}
    (failure,) = cases["verdict"]
    assert str(failure.text).splitlines()[-2:] == [
        f"{service.url}/runs/R-0001",
        f"clearance replay --service {service.url} R-0001 F1",
    ]
    (skipped,) = cases["baseline"]
    assert str(skipped.get("message")).startswith("No baseline: ")
    text = summary.read_text()
    assert text.startswith("# The job\n"), "a CI service gives one file to all steps"
    assert f"[R-0001]({service.url}/runs/R-0001)" in text
    assert "Labels: branch = main, build = 7" in text


def test_a_verdict_is_reused(
    service: Service, command: Command, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended(service, command, str(file)) == 0
    service.compare()
    assert command("submit", str(file), "--reuse").result(30) == 0
    assert "R-0001 is reused: " in capsys.readouterr().out
    assert service.rows()["runs"] == 1


@pytest.mark.parametrize(
    ("options", "statement"),
    [
        (["--baseline", "R-0042"], "baseline: R-0042 cannot be the baseline: there is no such run (given: R-0042)"),
        (["--label", "branch"], "invalid label 'branch': give KEY=VALUE, such as branch=main"),
        (["--no-wait", "--junit", "x.xml"], "need the verdict: leave --no-wait out"),
        (["--sweep", "avoider.d_0=1,2", "--reuse"], "--sweep cannot be combined with"),
        (["--junit", "/proc/none/j.xml"], "cannot be written"),
    ],
)
def test_what_cannot_be_done_is_refused_before_a_run_is_queued(
    service: Service,
    command: Command,
    file: Path,
    options: list[str],
    statement: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("submit", str(file), *options).result(30) == WRONG_INPUT
    assert statement in capsys.readouterr().err
    assert service.rows()["runs"] == 0


@pytest.mark.nightly
def test_a_job_that_is_stopped_cancels_its_run_if_asked(service: Service, tmp_path: Path) -> None:
    file = tmp_path / "campaign.yaml"
    file.write_text(yaml.safe_dump(campaign()))
    environment = {**os.environ, "CLEARANCE_SERVICE": service.url, "CLEARANCE_TOKEN": service.token()}
    states = {}
    for number, options in enumerate(([], ["--cancel-on-exit"]), 1):
        waiting = subprocess.Popen(
            [*CLEARANCE, "submit", str(file), *options],
            cwd=REPOSITORY, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert waiting.stderr is not None
        while "queued" not in (line := waiting.stderr.readline()):
            assert line, "it has ended"
        waiting.send_signal(signal.SIGTERM)
        statement = waiting.communicate(timeout=30)[1]
        with service.signed_in() as client:
            state = client.get(f"/api/v1/runs/R-000{number}").json()["state"]
        states[state] = (
            waiting.returncode,
            f"R-000{number} was cancelled, because this command was ended" in statement,
        )
    assert states == {"queued": (-signal.SIGTERM, False), "cancelled": (INTERRUPTED, True)}


@contextmanager
def deaf() -> Iterator[str]:
    """The address of a service that accepts connections and never answers."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"


def test_a_service_that_hangs_is_not_waited_for_beyond_the_patience(
    command: Command, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with deaf() as address:
        monkeypatch.setenv("CLEARANCE_SERVICE", address)
        began = time.monotonic()
        assert command("runs", "--patience", "1").result(30) == INTERNAL
    assert time.monotonic() - began < 10.0
    assert " 1 s: timed out" in capsys.readouterr().err


def test_what_a_service_that_hangs_did_is_not_known(
    service: Service, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a run that was to be cancelled; the time for that is short, whatever the patience."""
    monkeypatch.setattr(_following, "GRACE", 0.5)
    for patience in (0.0, 0.2, 120.0):
        with deaf() as address, Client(address, "t", patience=patience) as client:
            began = time.monotonic()
            statement = _following._cancelled(client, "R-0004")
        assert "is not known" in statement
        assert time.monotonic() - began < 10.0
    with Client(service.url, service.token()) as client:
        assert "is not known" not in _following._cancelled(client, "R-0004")


def test_a_file_that_contains_a_baseline_is_refused_by_a_service(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = {"label": "F1", "parameters": {"vehicle.m": 6.0}, "cost": 9.0}
    forged = {"run": "R-0001", "digest": "0" * 64, "threshold": 0.5, "cases": [case]}
    file = tmp_path / "forged.yaml"
    file.write_text(yaml.safe_dump(campaign() | {"baseline": forged}))
    assert command("submit", str(file)).result(30) == WRONG_INPUT
    assert fields(capsys.readouterr().err) == ["baseline"]
    assert invoke(["validate", str(file)]) in (0, WRONG_INPUT)
