"""Long work waits in its own short queues while the service stays responsive."""

from __future__ import annotations

import asyncio
import select
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, suppress
from types import ModuleType
from typing import Any

import httpx
import pytest

from backend.catalog import service as catalog
from backend.exports.formats import evaluations_csv, findings_csv, run_json, traces_mat
from backend.http import bodies
from backend.http.capacity import Capacities, Capacity
from backend.http.errors import RefusedError
from backend.previews.service import Previews
from backend.reports import pdf
from backend.reports import service as reports
from backend.runs import listing
from backend.scenes.recordings import pages as recordings
from backend.scenes.recordings import recording
from tests.given.finished_runs import finish
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit

MANY = 45
"""More than the number of threads shared by all requests."""


class Asked:
    """A pending request whose response is not read yet."""

    def __init__(
        self, service: Service, client: httpx.Client, path: str, method: str = "GET", more: str = "", body: str = ""
    ) -> None:
        self._socket = socket.create_connection(("127.0.0.1", service.port), timeout=60)
        cookie = f"{service.settings.cookie}={client.cookies[service.settings.cookie]}"
        head = f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nCookie: {cookie}\r\n{more}Connection: close\r\n\r\n"
        self._socket.sendall((head + body).encode())

    def fileno(self) -> int:
        return self._socket.fileno()

    def answer(self) -> tuple[int, str]:
        """The status and the headers in small letters."""
        received = b""
        while part := self._socket.recv(65536):
            received += part
        self._socket.close()
        head = received.partition(b"\r\n\r\n")[0].decode()
        return int(head.split(" ", 2)[1]), head.lower()


def at_night(*values: object) -> Any:
    """A parameter for `make nightly`."""
    return pytest.param(*values, marks=pytest.mark.nightly)


@pytest.fixture
def go() -> Iterator[threading.Event]:
    event = threading.Event()
    yield event
    event.set()


def answered(asked: list[Asked]) -> int:
    """How many have an answer, read or not."""
    return len(select.select(asked, [], [], 0)[0])


def hold(monkeypatch: pytest.MonkeyPatch, go: threading.Event, module: ModuleType, name: str, instead: Any) -> None:
    """Have this work last until it may go on, and done once: what matters is who may begin."""
    real: Callable[..., Any] = getattr(module, name)
    done: list[Any] = [] if instead is None else [instead]
    one = threading.Lock()

    def held(*given: Any, **named: Any) -> Any:
        assert go.wait(60)
        with one:
            if not done:
                made = real(*given, **named)
                done.append(list(made) if isinstance(made, Iterator) else made)
        return iter(done[0]) if isinstance(done[0], list) else done[0]

    monkeypatch.setattr(module, name, held)


def answers_at_once(service: Service, client: httpx.Client) -> None:
    """Health, the guard and what needs no shared thread."""
    with service.visitor() as stranger:
        stranger.timeout = httpx.Timeout(20.0)
        assert stranger.get("/api/v1/health").json() == {"status": "ok"}
        problem(stranger.get("/api/v1/runs"), 401)
    assert client.get("/api/v1/session", timeout=20.0).status_code == 200


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("path", "kind", "module", "name", "instead"),
    [
        # One of each kind by day; of files, that which is streamed.
        ("/api/v1/runs/R-0001/report.pdf", "pdf", pdf, "printed", b"%PDF"),
        at_night("/api/v1/runs/R-0001/report.html", "files", reports, "report_html", None),
        at_night("/api/v1/runs/R-0001/exports/findings.csv", "files", findings_csv, "findings_csv", None),
        at_night("/api/v1/runs/R-0001/exports/traces.mat", "files", traces_mat, "traces_mat", None),
        at_night("/api/v1/runs/R-0001/exports/run.json", "files", run_json, "run_json", None),
        ("/api/v1/runs/R-0001/exports/evaluations.csv", "files", evaluations_csv, "evaluations_csv", None),
        at_night("/api/v1/runs/R-0001/exports/flight-F1.html", "recordings", recordings, "record", None),
        ("/view/R-0001/F1/recorded/", "recordings", recordings, "record", None),
    ],
)
def test_long_work_is_bounded_and_the_rest_is_answered(
    service: Service,
    client: httpx.Client,
    monkeypatch: pytest.MonkeyPatch,
    go: threading.Event,
    path: str,
    kind: str,
    module: ModuleType,
    name: str,
    instead: Any,
) -> None:
    submit(client)
    finish(service)
    monkeypatch.setattr(recording, "RATE", 0.2)  # few frames: making a recording takes a second otherwise
    hold(monkeypatch, go, module, name, instead)
    capacity: Capacity = getattr(service.app.state.capacities, kind)
    capacity.waiting = 2
    asked = [Asked(service, client, path) for _ in range(MANY)]
    most = (capacity.at_once + 2) // 2  # of one user
    until(lambda: (capacity.inside, answered(asked)) == (most, MANY - most))
    answers_at_once(service, client)
    assert client.get("/api/v1/runs", timeout=20.0).status_code == 200, "the shared threads are free"
    go.set()
    answers = [one.answer() for one in asked]
    statuses = [status for status, _ in answers]
    assert (statuses.count(200), statuses.count(503)) == (most, MANY - most)
    refused = next(head for status, head in answers if status == 503)
    assert f"retry-after: {capacity.retry}\r\n" in refused + "\r\n"
    assert "content-type: application/problem+json" in refused
    until(lambda: capacity.inside == 0)


@pytest.mark.parametrize("path", ["/api/v1/campaigns/check", "/api/v1/campaigns/preview"])
def test_checks_of_campaigns_are_bounded(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, go: threading.Event, path: str
) -> None:
    hold(monkeypatch, go, bodies, "yaml_campaign", None)
    yaml = "Content-Type: application/yaml\r\nContent-Length: 1\r\n"
    asked = [Asked(service, client, path, "POST", yaml, "{") for _ in range(MANY)]
    reading = service.app.state.capacities.bodies
    most = (reading.at_once + reading.waiting) // 2  # of one user
    until(lambda: (reading.inside, answered(asked)) == (most, MANY - most))
    answers_at_once(service, client)
    assert client.get("/api/v1/runs", timeout=20.0).status_code == 200
    go.set()
    assert [one.answer()[0] for one in asked].count(503) == MANY - most


def test_what_is_read_is_checked_by_a_few_at_a_time(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, go: threading.Event
) -> None:
    hold(monkeypatch, go, catalog, "checked", None)
    checks: Capacity = service.app.state.capacities.checks
    checks.waiting = 2
    yaml = "Content-Type: application/yaml\r\nContent-Length: 1\r\n"
    asked = [Asked(service, client, "/api/v1/campaigns/check", "POST", yaml, "{") for _ in range(20)]
    most = (checks.at_once + 2) // 2  # of one user
    until(lambda: (checks.inside, answered(asked)) == (most, 20 - most))
    answers_at_once(service, client)
    go.set()
    assert [one.answer()[0] for one in asked].count(503) == 20 - most


@pytest.mark.nightly
def test_health_and_the_guard_answer_when_a_user_asks_for_more_than_one_may(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, go: threading.Event
) -> None:
    submit(client)
    begun: list[int] = []
    real = listing.summaries

    def held(*given: Any, **named: Any) -> Any:
        begun.append(1)
        assert go.wait(60)
        return real(*given, **named)

    monkeypatch.setattr(listing, "summaries", held)
    asked = [Asked(service, client, "/api/v1/runs") for _ in range(MANY)]
    until(lambda: len(begun) == 5)
    answers_at_once(service, client)
    go.set()
    assert {one.answer()[0] for one in asked} == {200}
    assert len(begun) == MANY


def test_a_wait_that_is_too_long_returns_retry_after(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, go: threading.Event
) -> None:
    submit(client)
    finish(service)
    hold(monkeypatch, go, reports, "report_html", None)
    files: Capacity = service.app.state.capacities.files
    files.patience = 0.05
    first = [Asked(service, client, "/api/v1/runs/R-0001/report.html") for _ in range(files.at_once // 2)]
    until(lambda: files.inside == files.at_once // 2)
    refused = client.get("/api/v1/runs/R-0001/report.html")
    assert "being written" in str(problem(refused, 503)["detail"])
    assert refused.headers["retry-after"] == "5"
    go.set()
    assert {one.answer()[0] for one in first} == {200}


def test_nothing_is_made_for_a_client_that_has_gone(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, go: threading.Event
) -> None:
    submit(client)
    finish(service)
    begun: list[int] = []
    real = reports.report_html

    def held(*given: Any) -> Any:
        begun.append(1)
        assert go.wait(60)
        return real(*given)

    monkeypatch.setattr(reports, "report_html", held)
    files: Capacity = service.app.state.capacities.files
    each = files.at_once // 2  # of one user
    first = [Asked(service, client, "/api/v1/runs/R-0001/report.html") for _ in range(each)]
    until(lambda: len(begun) == each)
    gone = Asked(service, client, "/api/v1/runs/R-0001/report.html")
    until(lambda: files.inside == each + 1)
    gone._socket.close()
    until(lambda: len(service.server.server_state.connections) <= each + 1)  # that of `client`, too
    go.set()
    assert {one.answer()[0] for one in first} == {200}
    until(lambda: files.inside == 0)
    assert len(begun) == each


@pytest.mark.parametrize("file", ["run.json", "evaluations.csv"])
def test_a_stream_for_a_run_that_is_not_there_is_a_problem(service: Service, client: httpx.Client, file: str) -> None:
    problem(client.get(f"/api/v1/runs/R-0099/exports/{file}"), 404)
    until(lambda: service.app.state.capacities.files.inside == 0)


# Without `reads`, which refuses nobody: all wait.
KINDS = [name for name, one in vars(Capacities()).items() if isinstance(one, Capacity) and name != "reads"]


@pytest.mark.parametrize("kind", [*KINDS, "previews"])
def test_a_user_who_asks_for_all_there_is_keeps_no_other_out(kind: str) -> None:
    async def asked() -> None:
        capacity: Capacity = Previews()._queue if kind == "previews" else getattr(Capacities(), kind)
        begun: list[str] = []

        async def job(account: str) -> None:
            async with capacity.turn(account):
                begun.append(account)
                await asyncio.Event().wait()

        jobs = [asyncio.create_task(job("greedy")) for _ in range(capacity.at_once + capacity.waiting)]
        for _ in range(5):
            await asyncio.sleep(0)
        other = asyncio.create_task(job("other"))
        for _ in range(5):
            await asyncio.sleep(0)
        assert any(one.done() for one in jobs), "the greedy one is refused"
        assert not other.done(), "the other one is not"
        assert ("other" in begun) == (capacity.at_once > 1)
        for one in (*jobs, other):
            one.cancel()
        await asyncio.gather(*jobs, other, return_exceptions=True)

    asyncio.run(asked())


def test_a_user_who_reads_slowly_blocks_nobody_else() -> None:
    capacity = Capacity("files are being written", 4, 12, 0.05, 5)

    async def asked(account: str, then: str = "") -> int:
        """How many of four jobs of a user get a turn while all of them go on; then those of another user."""
        async with AsyncExitStack() as held:
            for count in range(4):
                with suppress(RefusedError):
                    await held.enter_async_context(capacity.turn(account))
                    continue
                if then:
                    others.append(await asked(then))
                return count
            return 4

    others: list[int] = []
    assert asyncio.run(asked("slow", "other")) == 2
    assert others == [2]
    assert (capacity.inside, capacity._shares) == (0, {})
