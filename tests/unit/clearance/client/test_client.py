"""The Python client without a service: following by events, repeated requests, errors, files, arrays; both clients."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from pathlib import Path
from typing import Any

import anyio
import httpx
import pytest

from clearance.cli._following import _cancelled
from clearance.client import (
    AsyncClient,
    Client,
    ConflictError,
    ForbiddenError,
    InvalidAddressError,
    InvalidCampaignError,
    NotAClearanceServiceError,
    NotFoundError,
    NotSignedInError,
    PurgedError,
    RefusedError,
    UnreachableError,
    calls,
    drivers,
)
from clearance.client.answers import Run
from tests.given.small_catalogue import campaign

Answers = Callable[[httpx.Request], httpx.Response]
STAGELESS = (
    *("verdict", "reason", "error", "threshold", "nominal_cost", "worst_cost", "margin", "upper_bound", "started"),
    *("finished", "stage", "waits", "baseline", "summary", "remaining"),
)
"""Null while there is nothing."""


def document(state: str, **more: Any) -> dict[str, Any]:
    """A run as the service sends it."""
    texts = dict.fromkeys(("name", "owner", "campaign_name", "campaign_digest", "quantity", "unit", "notes"), "x")
    numbers = dict.fromkeys(("evaluations", "planned", "failed_evaluations"), 0)
    lists = {"tags": [], "labels": {}, "stages": [], "campaign": {"uncertain": {"vehicle.m": {}}}, "pinned": False}
    return {
        **dict.fromkeys(STAGELESS),
        **texts,
        **numbers,
        **lists,
        "created": 1.0,
        "id": "R-0001",
        "state": state,
        **more,
    }


class Clock:
    """Time that only passes in pauses, and by a second for each look at it."""

    def __init__(self) -> None:
        self.now, self.slept = 0.0, list[float]()

    def __call__(self) -> float:
        self.now += 1e-3
        return self.now

    def sleep(self, seconds: float) -> None:
        self.slept.append(round(seconds, 6))
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(drivers.time, "sleep", made.sleep)
    return made


def client(answers: Answers, clock: Clock | None = None, patience: float = 5.0) -> Client:
    made = Client("http://127.0.0.1:9/", "t", patience=patience, transport=httpx.MockTransport(answers))
    made.session.jitter = lambda: 1.0
    if clock is not None:
        made.session.clock = clock
    return made


def service(states: list[str], streams: list[str | None]) -> Answers:
    """The states that the run has when it is read, and the streams of events; None: there is none."""
    read, opened = iter(states), iter(streams)

    def answer(request: httpx.Request) -> httpx.Response:
        if not request.url.path.endswith("/events"):
            return httpx.Response(200, json=document(next(read)))
        text = next(opened)
        if text is None:
            return httpx.Response(404, json={})
        return httpx.Response(200, text=text, headers={"content-type": "text/event-stream; charset=utf-8"})

    return answer


def event(state: str, name: str = "run") -> str:
    return f"event: {name}\ndata: {json.dumps(document(state))}\nid: 1.000\n\n"


def followed(states: list[str], *streams: str | None) -> list[str]:
    return [run.state for run in client(service(states, [*streams])).follow("R-0001")]


def test_a_change_is_reported_when_it_is_sent_without_a_pause(clock: Clock) -> None:
    stream = "retry: 2000\n\n" + event("queued") + event("x", "stages") + event("running") + event("done")
    assert followed(["queued", "done"], stream) == ["queued", "queued", "running", "done"]
    assert clock.slept == []


@pytest.mark.parametrize(
    "stream", [None, "", ": still here\nevent: beat\ndata:\n\n", "event: run\ndata: no JSON\n\n", "<html>"]
)
def test_without_events_it_is_read_again_after_a_pause(stream: str | None, clock: Clock) -> None:
    assert followed(["running", "running", "done"], stream, stream) == ["running", "running", "done"]
    assert clock.slept == [1.0, 1.0], "never in a tight loop"


def test_a_stream_that_breaks_is_opened_again(clock: Clock) -> None:
    streams = (event("queued"), event("done"))
    assert followed(["queued", "running", "done"], *streams) == ["queued", "queued", "running", "done"]
    assert clock.slept == [1.0]


def test_a_run_that_has_ended_opens_no_stream() -> None:
    assert followed(["failed"]) == ["failed"]


def test_the_asynchronous_client_does_the_same() -> None:
    async def main() -> tuple[list[str], str]:
        answers = service(["queued", "done", "done"], [event("queued") + event("running") + event("done")])
        async with AsyncClient("http://x", "t", transport=httpx.MockTransport(answers)) as made:
            states = [run.state async for run in made.follow("R-0001")]
            return states, (await made.wait("R-0001")).state

    assert anyio.run(main) == (["queued", "queued", "running", "done"], "done")


def test_waiting_ends_at_its_limit_and_reports_changes(clock: Clock) -> None:
    seen: list[str] = []
    made = client(service(["running"] * 9, [None] * 9), clock)
    with pytest.raises(TimeoutError, match=r"R-0001 .* 3 s"):
        made.wait("R-0001", timeout=3.0, on_change=lambda run: seen.append(run.state))
    assert set(seen) == {"running"}
    assert 3.0 <= clock.now < 5.0


def test_no_request_takes_longer_than_what_is_left_of_the_limit(clock: Clock) -> None:
    answers, taken = service(["running"] * 9, ["", *[None] * 8]), list[float]()

    def timed(request: httpx.Request) -> httpx.Response:
        taken.append(request.extensions["timeout"]["read"] + clock.now)
        return answers(request)

    with pytest.raises(TimeoutError):
        client(timed, clock).wait("R-0001", timeout=3.0)
    assert len(taken) > 2
    assert max(taken) == pytest.approx(3.0, abs=0.1)


def in_turn(*given: httpx.Response | Exception) -> tuple[Answers, list[httpx.Request]]:
    """Answers one after the other, and the requests that they answered."""
    waiting: Iterator[httpx.Response | Exception] = iter(given)
    seen: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request)
        found = next(waiting)
        if isinstance(found, Exception):
            raise found
        return found

    return answer, seen


LOST, DONE = httpx.ConnectError("refused"), httpx.Response(201, json=document("queued"))


def busy(status: int, after: str | None = None, problem: bool = False) -> httpx.Response:
    headers = {} if after is None else {"Retry-After": after}
    kind = "application/problem+json" if problem else "text/html"
    return httpx.Response(status, headers=headers | {"content-type": kind}, content=b'{"detail": "busy"}')


def test_a_submission_is_repeated_with_the_same_key(clock: Clock) -> None:
    answers, seen = in_turn(LOST, busy(502), busy(503, "2", problem=True), busy(500), DONE)
    assert client(answers, clock, patience=60.0).submit(campaign()).id == "R-0001"
    assert len({request.headers["Idempotency-Key"] for request in seen}) == 1
    assert len({request.content for request in seen}) == 1
    assert clock.slept == [0.5, 1.0, 2.0, 4.0], "the service's own time is the least"


def test_two_submissions_are_two_requests() -> None:
    answers, seen = in_turn(DONE, DONE)
    made = client(answers)
    made.submit(campaign())
    made.submit(campaign())
    assert len({request.headers["Idempotency-Key"] for request in seen}) == 2


def test_a_date_of_retry_after_is_understood(clock: Clock) -> None:
    at = format_datetime(datetime.now(UTC) + timedelta(seconds=30), usegmt=True)
    answers, _ = in_turn(busy(429, at), DONE)
    client(answers, clock, patience=60.0).submit(campaign())
    assert 20.0 < clock.slept[0] <= 30.0


@pytest.mark.parametrize("after", ["", "soon", "-5", "1e9999", "٣"])
def test_a_retry_after_that_is_none_is_ignored(after: str, clock: Clock) -> None:
    headers = [(b"Retry-After", after.encode())]
    answers, _ = in_turn(httpx.Response(503, headers=headers, text="busy"), DONE)
    client(answers, clock).submit(campaign())
    assert clock.slept == [0.5]


def test_a_service_that_wants_more_time_than_there_is_is_not_waited_for(clock: Clock) -> None:
    answers, seen = in_turn(busy(429, "3600", problem=True))
    with pytest.raises(UnreachableError, match=" 5 s: busy"):
        client(answers, clock).run("R-0001")
    assert (len(seen), clock.slept) == (1, [])


def test_a_service_that_stays_away_is_reported_after_the_patience(clock: Clock) -> None:
    with pytest.raises(UnreachableError, match=" 5 s: refused"):
        client(in_turn(*[LOST] * 99)[0], clock).run("R-0001")
    assert sum(clock.slept) <= 5.0
    assert clock.slept == [0.5, 1.0, 2.0]


def hanging(clock: Clock, taken: list[float]) -> Answers:
    """A service that accepts every connection and never answers."""

    def hang(request: httpx.Request) -> httpx.Response:
        taken.append(request.extensions["timeout"]["read"])
        clock.now += taken[-1]
        raise httpx.ReadTimeout("timed out")

    return hang


@pytest.mark.parametrize("patience", [1.0, 5.0, 31.0, 45.0, 120.0])
def test_a_service_that_hangs_is_reported_after_the_patience(clock: Clock, patience: float) -> None:
    """Not after the usual time of an answer, which may be longer; that limits each try, as before."""
    taken = list[float]()
    with pytest.raises(UnreachableError, match=f" {patience:g} s: timed out"):
        client(hanging(clock, taken), clock, patience=patience).run("R-0001")
    assert clock.now <= patience + 0.2
    assert max(taken) == pytest.approx(min(patience, drivers.TIMEOUT), abs=0.1)


def test_no_patience_is_one_try_of_the_usual_time(clock: Clock) -> None:
    taken = list[float]()
    with pytest.raises(UnreachableError):
        client(hanging(clock, taken), clock, patience=0.0).run("R-0001")
    assert taken == [drivers.TIMEOUT]


def test_a_file_that_takes_long_to_make_is_not_limited_by_the_patience(clock: Clock, tmp_path: Path) -> None:
    taken = list[float]()
    with pytest.raises(UnreachableError):
        client(hanging(clock, taken), clock).report("R-0001", tmp_path / "report.html")
    assert taken == [calls.LONGEST]


def test_a_service_that_does_not_answer_is_noticed_while_its_answer_is_awaited() -> None:
    noticed, texts = threading.Event(), list[str]()

    def answer(request: httpx.Request) -> httpx.Response:
        assert noticed.wait(30), "the notice does not come while the service is silent"
        return httpx.Response(200, json=document("done"))

    made = client(answer, patience=120.0)
    made.session.notice = 0.01
    made.session.notify = lambda text: (texts.append(text), noticed.set())
    assert made.run("R-0001").state == "done"
    (text,) = texts
    assert all(part in text for part in (made.address, "0.01 s", "120 s"))


def test_a_service_that_answers_is_not_noticed() -> None:
    made = client(service(["done"], []))
    assert made.run("R-0001").state == "done"
    assert all(t.finished.is_set() for t in threading.enumerate() if isinstance(t, threading.Timer))


def test_what_cannot_succeed_is_not_repeated(clock: Clock) -> None:
    final = httpx.Response(503, headers={"content-type": "application/problem+json"}, json={"detail": "no Chromium"})
    answers, seen = in_turn(final)
    with pytest.raises(RefusedError, match="no Chromium"):
        client(answers, clock).run("R-0001")
    assert (len(seen), clock.slept) == (1, [])


def test_an_internal_error_is_asked_again_twice(clock: Clock) -> None:
    answers, seen = in_turn(*[busy(500, problem=True)] * 9)
    with pytest.raises(RefusedError, match="busy"):
        client(answers, clock, patience=60.0).run("R-0001")
    assert len(seen) == 3


@pytest.mark.parametrize(
    ("status", "kind"),
    [(401, NotSignedInError), (403, ForbiddenError), (404, NotFoundError), (409, ConflictError), (410, PurgedError)],
)
def test_a_refusal_has_its_type_and_the_sentence_of_the_service(status: int, kind: type[RefusedError]) -> None:
    problem = {"type": "urn:clearance:problem:a-kind", "detail": "of the service"}
    answers, _ = in_turn(httpx.Response(status, json=problem, headers={"content-type": "application/problem+json"}))
    with pytest.raises(kind, match="of the service") as caught:
        client(answers).run("R-0042")
    assert (caught.value.status, caught.value.kind) == (status, "a-kind")


def test_an_invalid_campaign_has_its_fields() -> None:
    errors = [{"field": "campaign.seed", "given": "x", "message": "give a whole number"}]
    problem = httpx.Response(
        422, json={"detail": "no", "errors": errors}, headers={"content-type": "application/problem+json"}
    )
    with pytest.raises(InvalidCampaignError) as caught:
        client(in_turn(problem)[0]).submit(campaign())
    assert [p.field for p in caught.value.problems] == ["campaign.seed"]


@pytest.mark.parametrize("given", [b"<html>", b"[]", b"{}", b'{"id": 1}', b"\xff"])
def test_what_is_no_clearance_service_is_reported(given: bytes) -> None:
    with pytest.raises(NotAClearanceServiceError):
        client(lambda _: httpx.Response(200, content=given)).run("R-0001")


def test_a_redirect_is_not_followed_with_the_token() -> None:
    answers, seen = in_turn(httpx.Response(307, headers={"location": "http://elsewhere/"}))
    with pytest.raises(RefusedError, match="307"):
        client(answers).run("R-0001")
    assert len(seen) == 1


@pytest.mark.parametrize(
    "address", ["nonsense", "ftp://x", "http://", "http://[", "http://x:y", "http://x?a", "\ud800", 5]
)
def test_an_address_that_is_none_is_refused_before_anything_is_sent(address: str) -> None:
    with pytest.raises(InvalidAddressError):
        Client(address, "t")


@pytest.mark.parametrize("token", ["two words", "ü", "a\nb"])
def test_a_token_that_is_none_is_refused(token: str) -> None:
    with pytest.raises(InvalidAddressError, match="one ASCII word"):
        Client("http://x", token)


@pytest.mark.parametrize("kind", [Client, AsyncClient])
@pytest.mark.parametrize("token", ["", " ", None])
def test_without_a_token_the_refusal_names_where_it_is_read(
    kind: type[Client], token: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CLEARANCE_TOKEN", raising=False)
    with pytest.raises(InvalidAddressError, match="CLEARANCE_TOKEN"):
        kind("http://x", token)


@pytest.mark.parametrize("patience", [math.nan, -1.0])
def test_a_patience_that_never_runs_out_is_refused(patience: float) -> None:
    with pytest.raises(ValueError, match="0 or more seconds"):
        Client("http://127.0.0.1:8000", "clr_x", patience=patience)


def test_a_name_cannot_leave_the_path_of_the_request() -> None:
    answers, seen = in_turn(httpx.Response(404))
    with pytest.raises(NotFoundError):
        client(answers).run("../tokens?x=#")
    assert seen[0].url.raw_path == b"/api/v1/runs/..%2Ftokens%3Fx%3D%23"


def test_downloads_of_one_file_at_the_same_time_do_not_mix(tmp_path: Path) -> None:
    """Nor do they touch a file of the user next to it."""
    (tmp_path / "run.json.part").write_bytes(b"own")
    file = tmp_path / "run.json"
    with drivers.written(file) as first, drivers.written(file) as second:
        first.write(b"first" * 9)
        second.write(b"second")
    assert file.read_bytes() == b"first" * 9
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.json", "run.json.part"]
    assert (tmp_path / "run.json.part").read_bytes() == b"own"


def test_an_incomplete_download_leaves_no_file(tmp_path: Path, clock: Clock) -> None:
    class Broken(httpx.SyncByteStream):
        def __iter__(self) -> Iterator[bytes]:
            yield b"half"
            raise httpx.ReadError("lost")

    answers = in_turn(httpx.Response(200, stream=Broken()), httpx.Response(404))[0]
    with pytest.raises(NotFoundError):
        client(answers, clock).report("R-0001", tmp_path / "report.html")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_none_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"'\.\./x' .* campaign\.yaml"):
        client(in_turn()[0]).export("R-0001", tmp_path / "out", ["../x"])
    assert list(tmp_path.iterdir()) == []


def test_a_later_service_may_answer_more() -> None:
    found = client(lambda _: httpx.Response(200, json=document("queued", more=[1]))).run("R-0001")
    assert found.document["more"] == [1]
    assert found.created == datetime(1970, 1, 1, 0, 0, 1, tzinfo=UTC)


def test_times_may_be_text_as_well() -> None:
    found = client(lambda _: httpx.Response(200, json=document("queued", created="2026-11-22T06:00:00Z"))).run("R-0001")
    assert found.created == datetime(2026, 11, 22, 6, tzinfo=UTC)


def test_evaluations_are_arrays_with_every_digit() -> None:
    text = "stage,kind,method,index,status,reason,seconds [s],d_min [m],vehicle.m [kg]\r\n"
    text += "0,nominal,,0,ok,,0.1,0.30000000000000004,5.0\r\n" + '2,search,direct,0,failed,"a, b",0.2,,4.0\r\n'
    run = [httpx.Response(200, json=document("done")) for _ in range(2)]
    answers, _ = in_turn(run[0], httpx.Response(200, text=text), run[1])
    found = client(answers).evaluations("R-0001")
    assert (found.names, found.criteria, found.units) == (("vehicle.m",), ("d_min",), {"vehicle.m": "kg", "d_min": "m"})
    assert found.costs[0] == 0.1 + 0.2
    assert [found.costs[1] != found.costs[1], *found.status] == [True, "ok", "failed"]
    assert found.reasons == {1: "a, b"}
    assert found.points.tolist() == [[5.0], [4.0]]
    with pytest.raises(ValueError, match="read-only"):
        found.points[0, 0] = 1.0
    pandas = pytest.importorskip("pandas")
    frame = found.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns[:2]) == ["vehicle.m", "d_min"]


def test_a_table_of_other_columns_is_refused() -> None:
    run = [httpx.Response(200, json=document("done")) for _ in range(2)]
    answers, _ = in_turn(run[0], httpx.Response(200, text="a,b\r\n"), run[1])
    with pytest.raises(ValueError, match="a, b"):
        client(answers).evaluations("R-0001")


def test_a_run_that_cannot_be_cancelled_is_reported(clock: Clock) -> None:
    given, run = client(in_turn(*[LOST] * 99)[0], clock, patience=100.0), Run.model_validate(document("queued"))
    with pytest.raises(UnreachableError) as lost:
        client(in_turn(*[LOST] * 99)[0], clock, patience=5.0).cancel("R-0001")
    assert _cancelled(given, run).endswith(f": {lost.value}")
