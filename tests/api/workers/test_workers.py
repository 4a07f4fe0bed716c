"""Whether anybody works: the workers with their runs, live over the event stream, and why a queued run waits."""

from __future__ import annotations

import re
import socket
import time
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import refusals, space, workers
from backend.db.queue import Queue
from backend.db.space import VARIABLE
from backend.db.tables import Run, RunRefusal, Worker
from backend.db.workers import Doing
from backend.events import hub
from backend.events.hub import Roster
from backend.events.watch import Watch
from backend.runs.waiting import SOON, UNREPORTED, doing_of, no_worker
from tests.given.event_streams import streaming
from tests.given.finished_runs import Work
from tests.given.openapi_document import conforms
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.waiting_runs import OLD


def asked(client: httpx.Client) -> dict[str, Any]:
    answer = client.get("/api/v1/workers")
    assert answer.status_code == 200, answer.text
    conforms(answer.json(), {"$ref": "#/components/schemas/Workers"})
    return dict(answer.json())


def arrive(service: Service, *names: str, run: int | None = None) -> None:
    with service.engine.begin() as connection:
        for name in names:
            workers.arrive(connection, name)
            workers.beat(connection, name, run, installation="here")


def silent(service: Service, name: str, seconds: float) -> None:
    """As if the worker had sent its last heartbeat that long ago."""
    with service.engine.begin() as connection:
        beat = time.time() - seconds
        connection.execute(sa.update(Worker).where(Worker.name == name).values(beat=beat, started=beat))


def listed(client: httpx.Client, run: str) -> dict[str, Any]:
    """The run as in the list; its own page says the same."""
    (found,) = client.get(f"/api/v1/runs?q={run}").json()["items"]
    assert client.get(f"/api/v1/runs/{run}").json()["waits"] == found["waits"]
    return dict(found)


def test_without_a_worker_the_last_one_is_known(service: Service, client: httpx.Client) -> None:
    none = asked(client)
    assert (none["alive"], none["last_seen"], none["items"]) == (0, None, [])
    arrive(service, "w1")
    silent(service, "w1", 48)
    found = asked(client)
    assert found["alive"] == 0
    assert found["now"] - found["last_seen"] == pytest.approx(48, abs=5)
    assert [(w["name"], w["state"]) for w in found["items"]] == [("w1", "silent")]
    with service.engine.begin() as connection:
        workers.leave(connection, "w1")
    found = asked(client)
    assert found["items"] == []
    assert found["now"] - found["last_seen"] < 5, "an orderly stop is remembered too"


def test_a_worker_killed_while_the_clock_was_ahead_is_not_alive(service: Service, client: httpx.Client) -> None:
    """Its last heartbeat is ahead once the clock is put right."""
    run, host = submit(client), socket.gethostname()
    arrive(service, "w1")
    with service.engine.begin() as connection:
        workers.beat(connection, "w1", None, ("s@1",), OLD, age=1.0)
        refusals.store(connection, 1, OLD, "other code")
    for ahead, alive in ((1.0, True), (86_400.0, False)):
        silent(service, "w1", -ahead)
        with service.engine.connect() as reader:
            assert (workers.live(reader), workers.alive(reader, host)) == (["w1"] if alive else [], alive)
            assert (workers.compared(reader, None) is not None, workers.last_seen(reader) is not None) == (alive, alive)
        assert asked(client)["alive"] == alive
        assert f'clearance_workers{{state="alive"}} {int(alive)}\n' in client.get("/metrics").text
        assert (listed(client, run)["waits"] == no_worker(None, 0.0)) == (not alive)
    with service.engine.begin() as connection, pytest.raises(KeyError):
        workers.drain(connection, "w1")


@pytest.mark.parametrize(("ahead", "refused"), [(1.0, True), (86_400.0, False)])
def test_a_refusal_of_a_clock_that_was_ahead_is_looked_at_again(
    service: Service, client: httpx.Client, ahead: float, refused: bool
) -> None:
    submit(client)
    with service.engine.begin() as connection:
        refusals.store(connection, 1, OLD, "other code")
        connection.execute(sa.update(RunRefusal).values(created=time.time() + ahead))
    assert (Queue(service.engine).claim("w1", (), OLD) is None) == refused


def test_every_worker_with_its_run_and_stage(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    submit(client, seed=2)
    arrive(service, "w1", "w2")
    work = Work(service)
    arrive(service, "w1", run=1)
    with service.engine.begin() as connection:
        workers.doing(connection, "w1", 1, "compiling", 14.2)
    found = asked(client)
    assert (found["alive"], found["queued"]) == (2, 1)
    busy, idle = sorted(found["items"], key=lambda w: w["state"])
    assert (busy["state"], busy["run"], busy["stage"], idle["state"], idle["run"]) == ("busy", run, None, "idle", None)
    assert busy["doing"]["sentence"] == doing_of(Doing("compiling", 1, 0.0, 14.2)).sentence
    assert " 15 s, " in busy["doing"]["sentence"]
    work.search(0, 10)
    assert {w["name"]: w["stage"] for w in asked(client)["items"]} == {"w1": "Search, direct", "w2": None}


def test_a_run_says_that_its_loop_is_compiled(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    arrive(service, "w1")
    assert Queue(service.engine).claim("w1") is not None
    arrive(service, "w1", run=1)
    assert listed(client, run)["doing"] is None
    with service.engine.begin() as connection:
        workers.doing(connection, "w1", 1, "compiling")
    doing = listed(client, run)["doing"]
    assert doing["sentence"] == doing_of(Doing("compiling", 1, 0.0, None)).sentence
    assert not re.search(r"\d", doing["sentence"]), "no number is invented"
    with service.engine.begin() as connection:
        workers.doing(connection, "w1", 2, "compiling")  # of another run
    assert listed(client, run)["doing"] is None
    with service.engine.begin() as connection:
        workers.doing(connection, "w1", 1)
    assert listed(client, run)["doing"] is None


@pytest.mark.parametrize("stored", [{"what": "compiling"}, {"x": 1}, [], "compiling"])
def test_what_another_version_stored_is_not_shown(service: Service, client: httpx.Client, stored: Any) -> None:
    run = submit(client)
    arrive(service, "w1")
    assert Queue(service.engine).claim("w1") is not None
    arrive(service, "w1", run=1)
    with service.engine.begin() as connection:
        connection.execute(sa.update(Worker).values(doing=stored))
    assert listed(client, run)["doing"] is None
    assert asked(client)["items"][0]["doing"] is None


def test_a_queued_run_says_why_it_waits(service: Service, client: httpx.Client) -> None:
    first, second, third = submit(client), submit(client, seed=2), submit(client, seed=3)
    assert listed(client, first)["waits"] == no_worker(None, 0.0)
    arrive(service, "w1", "w2")
    assert listed(client, first)["waits"] == SOON
    assert listed(client, second)["waits"].startswith("Position 2 ")
    for name, run in (("w1", 1), ("w2", 2)):
        assert Queue(service.engine).claim(name) is not None
        arrive(service, name, run=run)
    fourth = submit(client, seed=4)
    busy = (
        f"All 2 workers are busy with {first}, {second}; position {{}} in the queue. It starts automatically when one"
    )
    assert listed(client, third)["waits"].startswith(busy.format(1))
    assert listed(client, fourth)["waits"].startswith(busy.format(2))
    assert listed(client, first)["waits"] is None
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).where(Run.id == 4).values(priority=5))
    assert "position 1 in" in listed(client, fourth)["waits"]
    silent(service, "w1", 30)
    silent(service, "w2", 300)
    assert listed(client, third)["waits"] == no_worker(0.0, 30.0)


def test_a_run_does_not_wait_for_a_worker_that_is_busy_with_itself(service: Service, client: httpx.Client) -> None:
    """As after its worker was killed, until that counts as silent."""
    first, second = submit(client), submit(client, seed=2)
    arrive(service, "w1", run=1)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    Queue(service.engine).give_back(claim)
    assert listed(client, first)["waits"] == UNREPORTED
    assert listed(client, second)["waits"].partition("; ")[0].endswith(f"busy with {first}")
    arrive(service, "w2", run=7)
    assert listed(client, first)["waits"].partition(";")[0].endswith("busy with R-0007")
    workers_free(service, "w2")
    assert listed(client, first)["waits"] == SOON


def workers_free(service: Service, name: str) -> None:
    with service.engine.begin() as connection:
        workers.beat(connection, name, None)


def test_workers_that_begin_no_run_are_not_waited_for_in_vain(service: Service, client: httpx.Client) -> None:
    """The run says which of its workers could take it, and what is to be done if none does."""
    run = submit(client)
    arrive(service, "w1", "w2")
    with service.engine.begin() as connection:
        workers.beat(connection, "w1", None, short=True)
    assert listed(client, run)["waits"] == SOON
    assert {w["name"]: w["short"] for w in asked(client)["items"]} == {"w1": True, "w2": False}
    with service.engine.begin() as connection:
        workers.drain(connection, "w2")
    assert VARIABLE in listed(client, run)["waits"]
    with service.engine.begin() as connection:
        workers.drain(connection, "w1")
    assert listed(client, run)["waits"].endswith("`clearance worker`.")
    with service.engine.begin() as connection:
        workers.arrive(connection, "w1")
    assert listed(client, run)["waits"] == SOON


def test_the_stream_reports_workers(service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hub, "READ_PERIOD", 0.0)
    run = submit(client)
    with streaming(client) as stream, streaming(client, run=run) as other:
        assert stream.next("workers")["alive"] == 0
        assert other.next("run")["waits"] == no_worker(None, 0.0)
        arrive(service, "w1")
        stream.until("workers", alive=1)
        other.until("workers", alive=1)
        other.until("run", waits=SOON)


def test_falling_silent_is_noticed_though_nothing_is_written(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    submit(client)
    arrive(service, "w1")
    watch, seen = Watch(service.engine), Roster(service.engine, service.app.state.room)
    assert seen.look() == []
    watch.look([])
    (before,) = watch.everything(None)
    seen._due = 0.0
    monkeypatch.setattr("backend.workers.service.recent", lambda beat, at: False)
    monkeypatch.setattr("backend.runs.waiting.beating", lambda at: sa.false())
    (event,) = seen.look()
    assert '"alive":0' in event.data
    (after,) = watch.look([], moved=True)
    silence = no_worker(0.0, 0.0)
    assert (silence in after.data, silence in before.data) == (True, False)
    watch.close()


def test_a_heartbeat_alone_is_no_news(service: Service) -> None:
    arrive(service, "w1")
    seen = Roster(service.engine, service.app.state.room)
    seen.look()
    with service.engine.begin() as connection:
        workers.beat(connection, "w1", None)
    seen._due = 0.0
    assert seen.look() == []


def test_the_space_left_and_that_no_run_begins_are_news(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = asked(client)["space"]
    assert (found["limit"], found["short"]) == (service.settings.min_free, "")
    assert found["free"] > found["limit"]
    seen = Roster(service.engine, service.app.state.room)
    seen.look()
    for left, sentences in ((found["limit"] - 1, 1), (found["limit"] - 2, 0), (found["limit"] + 1, 1)):
        usage = SimpleNamespace(free=left)
        monkeypatch.setattr(space.shutil, "disk_usage", lambda _, usage=usage: usage)
        seen._due = 0.0
        assert len(seen.look()) == sentences
        assert bool(asked(client)["space"]["short"]) == (left < found["limit"])
