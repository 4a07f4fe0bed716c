"""Unreadable and oversized bodies: a clear error each, nothing stored, the service stays up."""

from __future__ import annotations

import asyncio
import json
import math
import threading
import tracemalloc
from collections.abc import Iterator

import httpx
import pytest

from backend.http.capacity import Capacities
from backend.http.errors import RefusedError
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import YAML

UNREADABLE = {
    "yaml syntax": ("name: [unclosed\n  x: 1", "application/yaml", "YAML"),
    "yaml alias": ("name: &a x\nsummary: *a", "application/yaml", "aliases"),
    "yaml key twice": ("name: x\nname: y", "application/yaml", "given twice"),
    "yaml object": ("name: !!python/object/apply:os.system [id]", "application/yaml", "YAML"),
    "yaml list": ("- 1", "application/yaml", "mapping"),
    "yaml deep": ("[" * 20000, "application/yaml", "YAML"),
    "empty yaml": ("", "application/yaml", "mapping"),
    "json syntax": ('{"campaign": ', "application/json", "JSON"),
    "json key twice": ('{"campaign": {}, "campaign": {}}', "application/json", "given twice"),
    "json deep": ("[" * 100_000, "application/json", "JSON"),
    "json many": ("[" + "[]," * 100_000 + "[]]", "application/json", "more than 100,000 lists"),
    "json list": ("[1]", "application/json", ""),
    "json nothing": ("{}", "application/json", "required"),
    "json nan": (json.dumps({"campaign": campaign(criterion={"threshold": math.nan})}), "application/json", "finite"),
    "unknown key": (json.dumps({"campaign": campaign(), "extra": 1}), "application/json", "Extra"),
    "bad tag": (json.dumps({"campaign": campaign(), "tags": ["a b"]}), "application/json", "pattern"),
    "no text": (b"\xff\xfe\x00", "application/json", "UTF-8"),
}  # fmt: skip


@pytest.mark.parametrize("case", UNREADABLE)
def test_an_unreadable_body_is_refused_and_stores_nothing(still: Service, guest: httpx.Client, case: str) -> None:
    content, kind, message = UNREADABLE[case]
    before = still.rows()
    answer = guest.post("/api/v1/runs", content=content, headers={"content-type": kind})
    assert message in str(problem(answer, 422)["errors"])
    assert still.rows() == before
    assert guest.get("/api/v1/health").json() == {"status": "ok"}


def test_few_bodies_are_read_at_a_time_and_the_queue_has_an_end() -> None:
    few = Capacities().bodies.at_once
    let_go, busy, most = threading.Event(), 0, 0
    lock = threading.Lock()

    def read() -> bool:
        nonlocal busy, most
        with lock:
            busy, most = busy + 1, max(most, busy + 1)
        let_go.wait(10)
        with lock:
            busy -= 1
        return True

    async def all_at_once() -> list[bool | BaseException]:
        readers = Capacities().bodies
        readers.waiting = 3
        asked = [asyncio.create_task(readers.run("", read)) for _ in range(10)]
        while sum(task.done() for task in asked) < 10 - few - 3 or busy < few:
            await asyncio.sleep(0.001)
        let_go.set()
        return await asyncio.gather(*asked, return_exceptions=True)

    answers = asyncio.run(asyncio.wait_for(all_at_once(), 10))
    refused = [answer for answer in answers if isinstance(answer, RefusedError)]
    assert most == few
    assert answers.count(True) == few + 3
    assert {(r.status, r.kind, str(r.headers)) for r in refused} == {(503, "busy", "{'Retry-After': '2'}")}


def test_malformed_yaml_is_reported_by_line(guest: httpx.Client) -> None:
    answer = guest.post("/api/v1/runs", content="name: x\nscenario: {a: 1, a: 2}\n", headers=YAML)
    errors = problem(answer, 422)["errors"]
    assert isinstance(errors, list)
    assert errors[0]["field"].startswith("line 2")


def test_another_media_type_is_refused(still: Service, guest: httpx.Client) -> None:
    problem(guest.post("/api/v1/runs", content="x", headers={"content-type": "text/csv"}), 415)
    problem(guest.post("/api/v1/runs", content="x"), 415)
    assert still.rows()["runs"] == 0


def test_before_a_worker_came_a_submit_answers_503(bare: Service) -> None:
    before = bare.rows()["runs"]
    with bare.visitor(authorization=f"Bearer {bare.token()}") as program:
        answer = program.post("/api/v1/runs", json={"campaign": campaign()})
        assert "clearance worker" in str(problem(answer, 503)["detail"])
        assert int(answer.headers["retry-after"]) > 0
        problem(program.get("/api/v1/components"), 503)
    assert bare.rows()["runs"] == before


def chunks(count: int, size: int = 1_000_000) -> Iterator[bytes]:
    for _ in range(count):
        yield b" " * size


def test_a_body_of_50_mb_is_refused_unread(still: Service, guest: httpx.Client) -> None:
    before = still.rows()
    tracemalloc.start()
    try:
        announced = guest.post("/api/v1/runs", content=b" " * 50_000_000, headers=YAML)
        tracemalloc.reset_peak()
        start = tracemalloc.get_traced_memory()[0]
        unannounced = guest.post("/api/v1/runs", content=chunks(50), headers=YAML)
        peak = tracemalloc.get_traced_memory()[1] - start
    finally:
        tracemalloc.stop()
    assert "at most 2,000,000 bytes" in str(problem(announced, 413)["detail"])
    assert "at most 2,000,000 bytes" in str(problem(unannounced, 413)["detail"])
    assert peak < 20_000_000
    assert still.rows() == before
    assert guest.get("/api/v1/health").json() == {"status": "ok"}
