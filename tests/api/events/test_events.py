"""Progress as server-sent events: sent at once, at most four times per second, by one poller for all listeners."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.queue import Queue
from backend.events import hub
from backend.events.watch import Event, Watch
from campaigns import thin
from tests.given.event_streams import Stream, streaming
from tests.given.finished_runs import Work, search
from tests.given.full_databases import fill
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit


def test_a_listener_to_all_runs_receives_active_runs_and_changes(service: Service, client: httpx.Client) -> None:
    first = submit(client)
    with streaming(client) as stream:
        assert (told := stream.next("run"))["id"] == first
        assert told == client.get(f"/api/v1/runs?q={first}").json()["items"][0]
        second = submit(client, seed=2)
        assert stream.next("run")["id"] == second
        client.post(f"/api/v1/runs/{first}/cancel")
        assert (told := stream.next("run"))["id"] == first
        assert told["state"] == "cancelled"


def test_a_listener_to_a_run_receives_its_stages_and_improvements(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    submit(client, seed=2)
    with streaming(client, run=run) as stream:
        assert stream.next("run")["state"] == "queued"
        assert stream.next("stages") == []
        work = Work(service)
        assert stream.next("run")["state"] == "running"
        assert [s["kind"] for s in stream.next("stages")] == ["nominal", "sensitivity", "search"]
        work.search(0, 50)
        heard = stream.next("evaluations")["2"]
        work.search(50, 100)
        more = stream.next("evaluations")["2"]
    flown = search(0, 150)
    better = thin.improvements(flown.costs[:, 0])
    assert heard["index"] + more["index"] == better.tolist()
    assert heard["cost"] + more["cost"] == flown.costs[better, 0].tolist()
    assert heard["seconds"] + more["seconds"] == flown.seconds[better].tolist()
    assert (heard["evaluations"], more["evaluations"], more["elapsed"]) == (50, 150, flown.seconds[-1])
    stored = client.get(f"/api/v1/runs/{run}/evaluations?max_points=1000").json()["stages"][0]
    assert heard["parameters"] == {path: values[heard["index"][-1]] for path, values in stored["parameters"].items()}
    assert heard["parameters"].keys() == {"vehicle.m", "vehicle.J"}
    last = better[-1] if more["index"] else None
    assert more["parameters"] == {path: v[last] for path, v in stored["parameters"].items() if last is not None}


def test_a_late_listener_receives_everything(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    work.search(0, 50)
    with streaming(client, run=run) as early:
        assert early.next("evaluations")["2"]["evaluations"] == 50
        work.search(50, 100)
        assert early.next("evaluations")["2"]["evaluations"] == 150
        with streaming(client, run=run) as late:
            told = late.next("evaluations")["2"]
    assert told["index"] == thin.improvements(search(0, 150).costs[:, 0]).tolist()


def test_a_finished_run_is_reported_once(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    client.post(f"/api/v1/runs/{run}/cancel")
    with streaming(client, run=run) as stream:
        assert stream.next("run")["state"] == "cancelled"


def test_the_end_of_a_run_is_published(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    with streaming(client, run=run) as stream:
        assert stream.next("run")["verdict"] is None
        work.conclude()
        assert (told := stream.next("run"))["verdict"] == "violated"
        assert told["state"] == "done"


@contextmanager
def resumed(client: httpx.Client, mark: str, **query: str) -> Iterator[Stream]:
    """A client that comes back as a browser does."""
    headers = {"Last-Event-ID": mark}
    with client.stream("GET", "/api/v1/events", params=query, headers=headers) as response:
        assert response.status_code == 200
        yield Stream(response)


def marks(block: list[str]) -> list[str]:
    return [line.removeprefix("id: ") for line in block if line.startswith("id: ")]


def told(stream: Stream, count: int) -> list[tuple[Any, str]]:
    """The next reported runs with their ids."""
    found: list[tuple[Any, str]] = []
    for block in stream.blocks():
        if "event: run" in block:
            (mark,) = marks(block)
            found.append((json.loads(block[1].removeprefix("data: ")), mark))
        if len(found) == count:
            break
    return found


def test_a_reconnecting_client_receives_runs_that_ended(service: Service, client: httpx.Client) -> None:
    fill(service, 20, finished=1.0, started=0.5, created=0.1, state="done")  # ended long ago: not reported again
    run, other = submit(client), submit(client, seed=2)
    work = Work(service)
    with streaming(client) as stream:
        ((_, _), (summary, mark)) = told(stream, 2)
        assert summary["state"] in ("running", "queued")
    work.conclude()
    assert client.get(f"/api/v1/runs/{run}").json()["state"] == "done"
    with resumed(client, mark) as stream:
        again = {summary["id"]: summary for summary, _ in told(stream, 2)}
        assert again.keys() == {run, other}
        assert (again[run]["state"], again[run]["verdict"]) == ("done", "violated")
        client.post(f"/api/v1/runs/{other}/cancel")
        ((summary, later),) = told(stream, 1)
        assert (summary["id"], summary["state"]) == (other, "cancelled")
    assert float(later) >= float(mark)
    with resumed(client, mark, run=run) as stream:
        assert stream.next("run")["verdict"] == "violated"


def test_an_empty_stream_has_a_mark(service: Service, client: httpx.Client) -> None:
    with streaming(client) as stream:
        mark = next(found[0] for block in stream.blocks() if (found := marks(block)))
    run = submit(client)
    client.post(f"/api/v1/runs/{run}/cancel")
    with resumed(client, mark) as stream:
        ((summary, _),) = told(stream, 1)
        assert (summary["id"], summary["state"]) == (run, "cancelled")


@pytest.mark.by_day(2)
@pytest.mark.parametrize("mark", ["x", "", "-1", "nan", "1e9", "9" * 400, "99999999999.000"])
def test_a_mark_that_was_not_given_here_counts_as_none(service: Service, client: httpx.Client, mark: str) -> None:
    run = submit(client)
    with resumed(client, mark) as stream:
        assert stream.next("run")["id"] == run


def test_of_events_that_come_together_the_last_alone_has_the_new_mark() -> None:
    listener = hub._Listener(None, 5.0)
    listener.send_all([Event(1, "run", "{}"), Event(2, "run", "{}")], 7.0)
    listener.send([Event(1, "run", "{}"), Event(1, "stages", "[]"), Event(2, "run", "{}")], 8.0)
    texts = [listener.queue.get_nowait() for _ in range(listener.queue.qsize())]
    assert marks("".join(text or "" for text in texts).splitlines()) == ["5.000", "7.000", "7.000", "8.000"]


def test_a_greeting_is_never_too_long() -> None:
    listener = hub._Listener(None)
    listener.send_all([Event(i, "run", "{}") for i in range(hub.BACKLOG + 1)], 7.0)
    assert listener.queue.qsize() == 1
    assert listener.queue.get_nowait() is not None


def test_an_unknown_run_is_refused(guest: httpx.Client) -> None:
    problem(guest.get("/api/v1/events", params={"run": "R-0099"}), 404)
    problem(guest.get("/api/v1/events", params={"run": "x"}), 404)


def test_a_listener_that_goes_is_forgotten_and_the_poller_rests(service: Service, client: httpx.Client) -> None:
    submit(client)
    with streaming(client) as stream:
        stream.next("run")
        assert service.app.state.hub.listeners == 1
    until(lambda: service.app.state.hub.listeners == 0)
    until(lambda: service.app.state.hub._poller.done())
    with streaming(client) as stream:
        stream.next("run")


def test_a_silent_stream_carries_beats_that_pages_and_the_client_see(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub, "HEARTBEAT", 0.05)
    with streaming(client) as stream:
        blocks = stream.blocks()
        assert next(blocks) == ["retry: 2000"]
        beat = [": still here", "event: beat", "data:"]
        assert beat in [next(blocks), next(blocks)]  # one of them may be the mark to come back with


def test_at_most_four_times_a_second(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    with streaming(client, run=run) as stream:
        stream.next("stages")
        begun, events, heard = time.monotonic(), 0, 0
        for first in range(0, 600, 10):
            work.search(first, 10)
        while heard < 600:
            heard = stream.next("evaluations").get("2", {}).get("evaluations", 0)
            events += 1
    assert events <= 2 + (time.monotonic() - begun) / hub.PERIOD


def test_a_listener_too_far_behind_is_let_go() -> None:
    listener = hub._Listener(None)
    listener.send([Event(1, "run", "{}")] * (hub.BACKLOG + 1))
    assert [listener.queue.get_nowait() for _ in range(hub.BACKLOG)][-1] is None


def test_nothing_is_read_while_nothing_is_written(service: Service, client: httpx.Client) -> None:
    run = int(submit(client)[2:])
    watch = Watch(service.engine)
    queries: list[str] = []
    sa.event.listen(service.engine, "before_cursor_execute", lambda *args: queries.append(args[2]))
    assert watch.look([run])
    queries.clear()
    assert watch.look([run]) == []
    assert queries == []
    assert Queue(service.engine).claim("w1") is not None
    queries.clear()
    assert [e.name for e in watch.look([run])] == ["run"]
    assert queries
    watch.close()


def test_polling_many_runs_stays_cheap(service: Service, client: httpx.Client) -> None:
    fill(service, 2000)
    watch = Watch(service.engine)
    watch.look([])
    assert watch.everything(None)
    submit(client, seed=3)
    begun = time.process_time()
    events = watch.look([])
    assert time.process_time() - begun < 0.5
    assert [e.run_id for e in events] == [2001]
    watch.close()
