"""How the command line follows a run: by the events of the service, by reading it again where there are none."""

from __future__ import annotations

import json
from collections.abc import Callable
from types import SimpleNamespace

import httpx
import pytest

from worker.cli import _remote
from worker.cli._following import _cancelled
from worker.cli._remote import Remote

Answers = Callable[[httpx.Request], httpx.Response]


@pytest.fixture
def pauses(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What would have been slept."""
    slept: list[float] = []
    clock = iter(range(10_000))
    monkeypatch.setattr(_remote, "time", SimpleNamespace(sleep=slept.append, monotonic=lambda: next(clock)))
    return slept


def remote(answers: Answers) -> Remote:
    made = Remote("http://127.0.0.1:9", "t", 5.0)
    made._client = httpx.Client(transport=httpx.MockTransport(answers), base_url="http://127.0.0.1:9/api/v1/")
    return made


def service(states: list[str], streams: list[str | None]) -> Answers:
    """The states that the run has when it is read, and the streams of events; None: there is none."""
    read, opened = iter(states), iter(streams)

    def answer(request: httpx.Request) -> httpx.Response:
        if not request.url.path.endswith("/events"):
            return httpx.Response(200, json={"id": "R-0001", "state": next(read)})
        text = next(opened)
        if text is None:
            return httpx.Response(404, json={})
        return httpx.Response(200, text=text, headers={"content-type": "text/event-stream; charset=utf-8"})

    return answer


def event(state: str, name: str = "run") -> str:
    return f"event: {name}\ndata: {json.dumps({'id': 'R-0001', 'state': state})}\nid: 1.000\n\n"


def followed(states: list[str], *streams: str | None) -> list[str]:
    return [document["state"] for document in remote(service(states, [*streams])).followed("R-0001")]


def test_a_change_is_shown_when_it_is_sent_without_a_pause(pauses: list[float]) -> None:
    stream = "retry: 2000\n\n" + event("queued") + event("x", "stages") + event("running") + event("done")
    assert followed(["queued", "done"], stream) == ["queued", "queued", "running", "done"]
    assert pauses == []


@pytest.mark.parametrize("stream", [None, "", ": still here\n\n", "event: run\ndata: no JSON\n\n", "<html>"])
def test_without_events_it_is_read_again_after_a_pause(stream: str | None, pauses: list[float]) -> None:
    assert followed(["running", "running", "done"], stream, stream) == ["running", "running", "done"]
    assert pauses == [1.0, 1.0], "never in a tight loop"


def test_a_stream_that_breaks_is_opened_again(pauses: list[float]) -> None:
    assert followed(["queued", "running", "done"], event("queued"), event("done")) == [
        "queued",
        "queued",
        "running",
        "done",
    ]
    assert pauses == [1.0]


def test_a_run_that_has_ended_opens_no_stream() -> None:
    assert followed(["failed"]) == ["failed"]


def test_a_run_that_cannot_be_cancelled_is_reported(pauses: list[float]) -> None:
    def lost(request: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("refused")

    given = remote(lost)
    given.patience = 100.0
    assert _cancelled(given, "R-0001").startswith(
        "R-0001 could not be cancelled: http://127.0.0.1:9 did not respond for 5 s"
    )
