"""A number that is another run's after a restore: no client reports the verdict of that run, or cancels it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import anyio
import pytest
import sqlalchemy as sa
import yaml

from backend.db.tables import Run, Sweep, SweepRun
from clearance import Client
from clearance.cli import WRONG_INPUT
from clearance.cli._following import _cancelled
from clearance.client import AsyncClient, ReplacedError, drivers
from clearance.client.replies import Reply
from clearance.client.session import Session
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

Command = Callable[..., int]


@pytest.fixture
def client(service: Service) -> Iterator[Client]:
    with Client(service.url, service.token("here"), patience=5.0) as made:
        yield made


def replaced(service: Service) -> None:
    """The database of before the first submission, in which another client submits next; its run is cleared."""
    with service.engine.begin() as connection:
        for table in (SweepRun, Sweep, Run):
            connection.execute(sa.delete(table))
    with service.signed_in() as browser:
        submit(browser, name="Another", seed=2)
    finish_fully(service)


def swept(service: Service, client: Client) -> None:
    """The same, with a sweep, which has ended."""
    with service.engine.begin() as connection:
        for table in (SweepRun, Sweep, Run):
            connection.execute(sa.delete(table))
    client.cancel_sweep(client.sweep(campaign(), "avoider.d_0", [3, 4]).id)


@pytest.fixture
def meanwhile(service: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    """Replaces the database while a client waits between two requests: there is no stream of events."""

    async def sleep(*_: object) -> None:
        replaced(service)

    async def none(*_: object) -> Any:
        for line in list[str]():
            yield line

    monkeypatch.setattr(Session, "lines", none)
    for driver in (drivers.Blocking, drivers.Awaiting):
        monkeypatch.setattr(driver, "sleep", sleep)


def test_search_returns_no_verdict_of_another_run(client: Client, meanwhile: None) -> None:
    with pytest.raises(ReplacedError, match=r"R-0001 .*sha256.*sha256.* restored"):
        client.search(campaign())


def test_the_asynchronous_client_waits_for_no_other_run(service: Service, meanwhile: None) -> None:
    async def waited() -> None:
        async with AsyncClient(service.url, service.token()) as client:
            await client.submit(campaign())
            await client.wait("R-0001")  # the first answer states what is waited for

    with pytest.raises(ReplacedError):
        anyio.run(waited)


@pytest.mark.parametrize("first", ["submit", "follow"])
def test_a_command_reports_no_verdict_of_another_run(
    client: Client, command: Command, meanwhile: None, tmp_path: Path, capsys: pytest.CaptureFixture[str], first: str
) -> None:
    file, out, junit, summary = (tmp_path / name for name in ("c.yaml", "out", "junit.xml", "summary.md"))
    file.write_text(yaml.safe_dump(campaign()))
    given = file if first == "submit" else client.submit(campaign()).id
    assert command(first, given, "--out", out, "--junit", junit, "--summary", summary) == WRONG_INPUT
    told = capsys.readouterr()
    assert "leared" not in told.out + told.err
    assert told.err.count("sha256") == 2, "the error that names both runs"
    assert list(out.iterdir()) == []
    assert "<error" in junit.read_text()
    assert not summary.exists() or "leared" not in summary.read_text()


def test_an_event_of_another_run_is_refused(service: Service, client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    queued = client.submit(campaign())

    async def begun(session: Session, call: Any) -> Any:
        replaced(service)
        with Client(service.url, service.token("other")) as other:
            text = other.run("R-0001").model_dump_json()
        for line in ("event: run", f"data: {text}"):
            yield line

    monkeypatch.setattr(Session, "lines", begun)
    with pytest.raises(ReplacedError):
        list(client.follow(queued))


def test_no_other_run_is_cancelled(service: Service, client: Client) -> None:
    queued = client.submit(campaign())
    with service.engine.begin() as connection:
        connection.execute(sa.delete(Run))
    other = client.submit(campaign(seed=2))
    assert other.id == queued.id
    with pytest.raises(ReplacedError) as refused:
        client.cancel(queued)
    assert _cancelled(client, queued).endswith(f": {refused.value}")
    assert client.run("R-0001").state == "queued"
    assert client.cancel(other).state == "cancelled"


def test_a_cancel_that_is_repeated_after_a_restore_cancels_no_other_run(
    service: Service, client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The service does not answer, and is back with another database."""
    queued, send = client.submit(campaign()), Session.send
    tries = list[str]()

    async def lost(session: Session, call: Any, *arguments: Any) -> Any:
        if call.method == "POST" and not tries:
            tries.append(call.path)
            with service.engine.begin() as connection:
                connection.execute(sa.delete(Run))
            with service.signed_in() as browser:
                submit(browser, name="Another")
            return Reply(0, "", {}, b"lost")
        return await send(session, call, *arguments)

    monkeypatch.setattr(Session, "send", lost)
    with pytest.raises(ReplacedError):
        client.cancel(queued)
    assert client.run("R-0001").state == "queued"


def test_no_file_or_finding_of_another_run_is_returned(service: Service, client: Client, tmp_path: Path) -> None:
    queued = client.submit(campaign())
    finish_fully(service)
    done = client.wait(queued)
    replaced(service)
    for read in (client.findings, client.evaluations, client.traces, client.signoffs, client.campaign_text, client.run):
        with pytest.raises(ReplacedError):
            read(done)
    with pytest.raises(ReplacedError):
        client.export(done, tmp_path / "out")
    assert list((tmp_path / "out").iterdir()) == []
    (tmp_path / "out" / "report.html").write_text("earlier")
    with pytest.raises(ReplacedError):
        client.report(done, tmp_path / "out" / "report.html")
    assert [file.read_text() for file in (tmp_path / "out").iterdir()] == ["earlier"]
    assert client.findings(client.run("R-0001")), "the answer that is given states what is meant"


@pytest.mark.parametrize("follow", [True, False])
def test_no_other_sweep_is_reported(
    service: Service, client: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, follow: bool
) -> None:
    token = service.token("other")

    async def sleep(*_: object) -> None:
        with Client(service.url, token) as other:
            swept(service, other)

    monkeypatch.setattr(drivers.Blocking, "sleep", sleep)
    sweep = client.sweep(campaign(), "avoider.d_0", [1, 2])
    with pytest.raises(ReplacedError, match=r"S-0001 .*avoider\.d_0.* restored"):
        print(*(client.follow_sweep(sweep) if follow else [client.wait_sweep(sweep)]))
    with pytest.raises(ReplacedError):
        client.cancel_sweep(sweep)
    with pytest.raises(ReplacedError):
        client.export_sweep(sweep, tmp_path / "sweep.csv")
    assert not (tmp_path / "sweep.csv").exists()
