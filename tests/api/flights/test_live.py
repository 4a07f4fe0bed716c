"""The client of the what-if simulation process: the real process once, and misbehaving stand-ins."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from backend.scenes.base.flight import from_live
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from campaigns import library, load_file
from tests.given.service import until

STAND_IN = """
import json, sys, os, time
print(json.dumps({"ready": True}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    does = asked["parameters"].get("does", 0)
    if does == 1: os._exit(3)
    if does == 2: print("garbage", flush=True); continue
    if does == 3: time.sleep(60)
    if does == 4: print(json.dumps({"id": asked["id"], "error": "no such flight"}), flush=True); continue
    if does == 6 and not os.path.exists(asked["campaign"]["name"]):
        open(asked["campaign"]["name"], "x").close(); print(json.dumps({"stale": True}), flush=True); break
    if does == 7: print(json.dumps({"stale": True}), flush=True); break
    if does == 5: print("[1, 2]", flush=True); continue
    print(json.dumps({"id": asked["id"], "status": "ok", "pid": os.getpid(), **asked["parameters"]}), flush=True)
"""

STARTING = "still starting: ask again"


@pytest.fixture
def live() -> Iterator[Live]:
    live = Live((sys.executable, "-c", STAND_IN), limit=2.0, first_limit=30.0)
    yield live
    live.close()


def fly(live: Live, does: float = 0, **more: float) -> dict[str, Any]:
    return live.simulate({}, "digest", {"does": does, **more}, 100)


def test_one_process_answers_many(live: Live) -> None:
    assert fly(live)["pid"] == fly(live)["pid"]
    answers: dict[int, float] = {}

    def ask(x: int) -> None:
        answers[x] = fly(live, x=x)["x"]

    threads = [threading.Thread(target=ask, args=(i,), daemon=True) for i in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10)
    assert answers == {i: i for i in range(20)}


@pytest.mark.parametrize(
    ("does", "statement"), [(1, "ended unexpectedly"), (2, "unreadable"), (3, "timed out"), (5, "unreadable")]
)
def test_a_process_that_fails_is_reported_and_restarted(live: Live, does: int, statement: str) -> None:
    before = fly(live)["pid"]
    with pytest.raises(LiveError, match=statement):
        fly(live, does)
    assert fly(live)["pid"] != before


def test_a_process_that_loaded_other_code_is_started_again_and_asked_again(live: Live, tmp_path: Path) -> None:
    before = fly(live)["pid"]
    after = live.simulate({"name": str(tmp_path / "changed")}, "digest", {"does": 6}, 100)
    assert (after["status"], after["does"]) == ("ok", 6)
    assert after["pid"] != before
    with pytest.raises(LiveError, match="keeps changing"):
        fly(live, 7)


def test_a_refusal_is_a_sentence_and_no_failure(live: Live) -> None:
    before = fly(live)["pid"]
    with pytest.raises(LiveError, match="no such flight"):
        fly(live, 4)
    assert fly(live)["pid"] == before


def test_a_failure_is_reported_to_all_waiting_clients(live: Live) -> None:
    fly(live)
    statement: list[str] = []

    def ask(does: float) -> None:
        try:
            fly(live, does)
        except LiveError as error:
            statement.append(str(error))

    threads = [threading.Thread(target=ask, args=(does,), daemon=True) for does in (3, 0, 0)]
    threads[0].start()
    until(lambda: live._child is not None and live._child._open_requests)
    for thread in threads[1:]:
        thread.start()
    for thread in threads:
        thread.join(10)
    assert len(statement) == 3
    assert fly(live)["status"] == "ok"


def test_a_process_that_starts_slowly_is_waited_for_by_later_requests(tmp_path: Path) -> None:
    """It was ended with the first request that it kept waiting, so that on a busy machine it never started."""
    gate = tmp_path / "gate"
    os.mkfifo(gate)
    live = Live((sys.executable, "-c", f"open({str(gate)!r}).close()\n{STAND_IN}"), limit=30.0, first_limit=0.1)
    try:
        for x in range(2):
            with pytest.raises(LiveError, match=STARTING):
                fly(live, x=x)
        child = live._child
        assert child is not None
        assert not child.over
        live._first_limit = 30.0
        gate.open("w").close()
        assert fly(live, x=2)["x"] == 2, "and not the answer to an earlier one"
        assert live._child is child
    finally:
        live.close()


def test_a_request_larger_than_a_pipe_waits_alone_until_the_process_reads(tmp_path: Path) -> None:
    """It waits for the process while it is written, too: its limit counts, and nobody else waits with it."""
    gate = tmp_path / "gate"
    os.mkfifo(gate)
    live = Live((sys.executable, "-c", f"open({str(gate)!r}).close()\n{STAND_IN}"), limit=30.0, first_limit=0.1)
    large = {"notes": "x" * 500_000}
    try:
        for _ in range(2):
            with pytest.raises(LiveError, match=STARTING):
                live.simulate(large, "large", {}, 100)
        live._first_limit = 30.0
        gate.open("w").close()
        assert live.simulate(large, "large", {"x": 3.0}, 100)["x"] == 3.0  # type: ignore[typeddict-item]
    finally:
        live.close()


def test_a_process_that_cannot_be_started_is_reported() -> None:
    live = Live(("/nowhere/at/all",))
    with pytest.raises(LiveError, match="could not be started"):
        fly(live)
    live.close()


def test_after_closing_nothing_is_simulated(live: Live) -> None:
    fly(live)
    child = live._child
    live.close()
    assert child is not None
    assert child._process is not None
    child._process.wait(10)
    with pytest.raises(LiveError, match="stopping"):
        fly(live)


def test_the_real_process_simulates_the_shipped_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a folder with a module of the same name, which it does not import."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "worker").mkdir()
    (tmp_path / "worker" / "__init__.py").write_text("raise SystemExit(7)")
    campaign = load_file(library()["unicycle_static"])
    live = Live(first_limit=120.0)  # a cold cache compiles first
    try:
        nominal = live.simulate(campaign.document(), campaign.digest, {}, 400)
        worst = live.simulate(campaign.document(), campaign.digest, {"vehicle.m": 6.0, "vehicle.J": 0.06}, 400)
        with pytest.raises(LiveError, match=r"'vehicle\.mass'"):
            live.simulate(campaign.document(), campaign.digest, {"vehicle.mass": 6.0}, 400)
    finally:
        live.close()
    assert nominal["cost"] == pytest.approx(0.94356, abs=1e-5)
    assert worst["cost"] == pytest.approx(0.9417402, abs=2e-6)
    flight = from_live(worst)
    assert flight is not None
    assert flight.closest is not None
    assert flight.at(flight.closest.time)[2] == pytest.approx(worst["cost"], abs=1e-3)


@pytest.mark.nightly
def test_only_the_newest_is_done() -> None:
    begun, go, done = threading.Event(), threading.Event(), []

    def work(value: int) -> None:
        begun.set()
        go.wait(10)
        done.append(value)

    latest = Latest(work)
    latest.ask(0)
    assert begun.wait(10)
    for value in range(1, 50):
        latest.ask(value)
    go.set()
    until(lambda: len(done) == 2)
    latest.stop()
    assert done == [0, 49]


def test_work_that_fails_does_not_end_the_worker(caplog: pytest.LogCaptureFixture) -> None:
    done: list[int] = []

    def work(value: int) -> None:
        if value == 0:
            raise RuntimeError("no")
        done.append(value)

    latest = Latest(work)
    latest.ask(0)
    until(lambda: "what-if" in caplog.text)
    latest.ask(1)
    until(lambda: done == [1])
    latest.stop()
