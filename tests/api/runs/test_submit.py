"""`clearance submit` and `clearance follow` against a real service: exit codes, files, refusals, outages."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest
import yaml

from backend.db.queue import Queue
from clearance.cli import INTERNAL, INTERRUPTED, WRONG_INPUT, invoke
from clearance.cli._exports import LIST
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

Command = Callable[..., "Future[int]"]


@pytest.fixture
def command(service: Service, monkeypatch: pytest.MonkeyPatch) -> Iterator[Command]:
    """The command line as a process, with the service's address and a token in its environment."""
    monkeypatch.setenv("CLEARANCE_SERVICE", service.url)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    pool = ThreadPoolExecutor(1)
    yield lambda *arguments: pool.submit(invoke, [arguments[0], "--patience", "5", *map(str, arguments[1:])])
    pool.shutdown(wait=False)  # what a failed test leaves waiting ends with the service


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "campaign.yaml"
    path.write_text(f"# Reviewed in November.\n{yaml.safe_dump(campaign())}")
    return path


def queued(service: Service) -> bool:
    return service.rows()["runs"] == 1


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("verdict", "code"), [("cleared", 0), ("violated", 1), ("inconclusive", 2)])
def test_the_verdict_is_the_exit_code(
    service: Service, command: Command, file: Path, verdict: str, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    ending = command("submit", file, "--name", "Nightly", "--tag", "ci", "--tag", "main")
    until(lambda: queued(service))
    finish_fully(service, verdict)
    assert ending.result(30) == code
    told, shown = capsys.readouterr()
    assert told.splitlines()[0] == verdict.capitalize()
    assert "stayed above 0.5 m" in told
    assert told.rstrip().endswith(f"{service.url}/runs/R-0001")
    assert shown.splitlines()[0] == f"R-0001 is at {service.url}/runs/R-0001"
    with service.signed_in() as client:
        run = client.get("/api/v1/runs/R-0001").json()
    assert (run["name"], run["tags"], run["owner"], run["token"]) == ("Nightly", ["ci", "main"], "local", "ci")
    assert shown.splitlines()[1] == f"At most {run['planned']:,} evaluations."


def test_the_files_are_those_of_the_service(service: Service, command: Command, file: Path, tmp_path: Path) -> None:
    assert command("submit", file, "--no-wait").result(30) == 0
    finish_fully(service)
    out = tmp_path / "out"
    assert command("follow", "R-0001", "--out", out).result(30) == 0
    made = ["campaign.yaml", "evaluations.csv", "findings.csv", "report.html", "run.json"]
    assert sorted(f.name for f in out.iterdir()) == [LIST, *made]
    modeline = f"# yaml-language-server: $schema={service.url}/api/v1/campaigns/schema\n"
    assert (out / "campaign.yaml").read_text() == modeline + file.read_text()
    with service.signed_in() as client:
        for name in ("evaluations.csv", "findings.csv"):
            assert (out / name).read_bytes() == client.get(f"/api/v1/runs/R-0001/exports/{name}").content
    assert json.loads((out / "run.json").read_text())["run"]["id"] == "R-0001"
    assert '<p class="eyebrow">' in (out / "report.html").read_text()
    with service.visitor() as editor:  # without a token
        schema = editor.get(modeline.partition("=")[2].strip())
    assert schema.json()["title"] == "Campaign"
    assert command("validate", out / "campaign.yaml", "--service", service.url).result(30) == 0


def test_for_programs_it_prints_the_run_and_nothing_else(
    service: Service, command: Command, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command("submit", file, "--no-wait").result(30) == 0
    assert capsys.readouterr() == ("R-0001\n", "")
    finish_fully(service)
    assert command("follow", "R-0001", "--json").result(30) == 0
    told, shown = capsys.readouterr()
    assert json.loads(told)["verdict"] == "cleared"
    assert shown == ""


def test_a_run_without_a_verdict_is_none(
    service: Service, command: Command, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for run in ("R-0001", "R-0002"):
        assert command("submit", file, "--no-wait").result(30) == 0
        assert capsys.readouterr().out.strip() == run
    with service.signed_in() as client:
        assert client.post("/api/v1/runs/R-0001/cancel").status_code == 200
    queue = Queue(service.engine)
    claim = queue.claim("w1")
    assert claim is not None
    error = "the trim has no solution"
    queue.fail(claim, error)
    out = tmp_path / "out"
    assert command("follow", "R-0001", "--out", out).result(30) == INTERRUPTED
    assert "No verdict" in (out / "report.html").read_text()
    assert "Cancelled: no verdict" in capsys.readouterr().out
    assert command("follow", "R-0002").result(30) == INTERNAL
    assert error in capsys.readouterr().out


def test_a_service_that_comes_back_is_waited_for(
    service: Service, command: Command, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shown = ""

    def seen() -> bool:
        nonlocal shown
        shown += capsys.readouterr().err
        return "R-0001 queued" in shown

    ending = command("submit", file)
    until(seen)
    service.stop()
    again = Service(service.settings, service.port)
    again.start()
    try:
        finish_fully(again)
        assert ending.result(30) == 0
    finally:
        again.stop()


def test_a_service_that_cannot_be_reached_is_reported(
    command: Command, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("submit", file, "--service", "http://127.0.0.1:9", "--patience", "0")
    assert command(*arguments).result(30) == INTERNAL
    assert "http://127.0.0.1:9 " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "statement"),
    [
        (["follow", "R-0042"], "there is no run"),
        (["follow", "../tokens"], "invalid run number"),
        (["follow", "R-0001", "--service", "nonsense"], "is not the address of a service"),
        (["follow", "R-0001", "--token-file", "missing"], "the token's file missing cannot be read"),
        (["submit", "missing.yaml"], "the file cannot be read"),
    ],
)
def test_an_impossible_request_is_reported(
    command: Command, arguments: list[str], statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(*arguments).result(30) == WRONG_INPUT
    assert statement in capsys.readouterr().err


@pytest.mark.parametrize(
    ("token", "statement"), [("", "no API token"), ("clr_wrong", "token"), ("zwei Worte", "one ASCII word")]
)
def test_a_token_is_needed(
    command: Command, token: str, statement: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEARANCE_TOKEN", token)
    assert command("follow", "R-0001").result(30) == WRONG_INPUT
    assert statement in capsys.readouterr().err


def test_refusals_of_the_service_are_reported_by_field(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = campaign()
    document["scenario"]["vehicle"]["component"] = "hovercraft"
    file = tmp_path / "hover.yaml"
    file.write_text(yaml.safe_dump(document))
    assert command("submit", file).result(30) == WRONG_INPUT
    statement = capsys.readouterr().err
    assert "hover.yaml cannot be used:" in statement
    assert "scenario.vehicle.component" in statement
    assert "hovercraft" in statement
    assert not queued(service)
