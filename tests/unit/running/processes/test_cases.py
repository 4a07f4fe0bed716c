"""What-if evaluations of a simulator: one call with its trace and its time, or a sentence."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from worker.running.catalogue import installed
from worker.running.processes import cases
from worker.running.processes.cases import Systems, answer, close

PROGRAM = """import json, os, sys, time
for line in sys.stdin:
    asked = json.loads(line)
    a = asked["parameters"]["a"]
    open("calls", "a").write("x")
    if a == 0.75:
        os._exit(3)
    time.sleep(2.1 if a == 0.5 else 0)
    answer = {"results": {"d": 2 * a}}
    if asked.get("trace") and a != 0.25:
        answer["trace"] = {"time": list(range(5000)), "x": [a] * 5000}
    print(json.dumps(answer), flush=True)
"""
DESCRIBED: dict[str, Any] = {
    "name": "asked",
    "command": [sys.executable, "{folder}/program.py"],
    "parameters": {"a": {"nominal": 0.1, "low": 0, "high": 1}},
    "results": {"d": {"unit": "m"}},
    "trace": {"time": {}, "x": {"unit": "m"}},
    "scene": {"frame": "z_up", "vehicle": {"position": ["x", 0]}},
    "slots": 4,
    "timeout": 5,
}
CAMPAIGN = {
    "name": "Asked",
    "simulator": {"name": "asked"},
    "uncertain": {"simulator.a": {"low": 0.0, "high": 1.0}},
    "criterion": {"result": "d", "threshold": 0.5},
    "stages": {"search": [{"method": "direct", "evaluations": 10}]},
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The operator's folder; the catalogue is read again."""
    (tmp_path / "asked").mkdir()
    (tmp_path / "asked" / "program.py").write_text(PROGRAM, encoding="utf-8")
    describe(tmp_path)
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path))
    yield tmp_path
    installed.forget_simulators()


def describe(folder: Path, **changes: Any) -> None:
    text = yaml.safe_dump(DESCRIBED | changes)
    (folder / "asked" / "simulator.yaml").write_text(text, encoding="utf-8")


@pytest.fixture
def systems() -> Iterator[Systems]:
    found: Systems = {}
    yield found
    close(found)


def version() -> str:
    installed.forget_simulators()
    entry = installed.catalogue().simulator("asked")
    assert entry is not None
    return entry.version


def ask(systems: Systems, campaign: Any = CAMPAIGN, simulator: str = "", rows: int = 100, **given: Any) -> Any:
    request = {"id": 1, "campaign": campaign, "simulator": simulator, "rows": rows}
    return answer(json.dumps(request | {"parameters": {f"simulator.{n}": v for n, v in given.items()}}), systems)


def test_one_call_in_one_warm_process(folder: Path, systems: Systems) -> None:
    first = ask(systems, simulator=version(), a=0.2)
    assert (first["status"], first["cost"], first["margin"], first["untraced"]) == ("ok", 0.4, 0.4 - 0.5, "")
    assert first["meta"]["parameters"] == {"simulator.a": 0.2}
    assert first["meta"]["scene"]["frame"] == "z_up"
    assert 0.0 < first["seconds"] < 2.0, "the time of a process that was there"
    assert [len(column) for column in first["data"].values()] == [100, 100]
    (opened,) = systems.values()
    assert len(opened.system._pool._slots) == 1  # type: ignore[attr-defined]
    again = ask(systems, a=0.3)
    assert (again["id"], again["cost"]) == (1, 0.6)
    (still,) = systems.values()
    assert still is opened


@pytest.mark.parametrize(
    ("a", "status", "reason", "untraced"),
    [
        (0.25, "ok", "", "its answer has no object `trace`"),
        (0.75, "failed", "its process ended with exit code 3", ""),
    ],
)
def test_what_goes_wrong_is_a_status(
    folder: Path, systems: Systems, a: float, status: str, reason: str, untraced: str
) -> None:
    found = ask(systems, a=a)
    assert (found["status"], found["cost"] is None, found["data"]) == (status, status != "ok", {})
    assert reason in found["reason"]
    assert untraced in found["untraced"]
    assert bool(untraced) == bool(found["untraced"])
    assert ask(systems, a=0.2)["cost"] == 0.4


def test_a_slow_one_is_evaluated_once(folder: Path, systems: Systems) -> None:
    began = time.monotonic()
    found = ask(systems, a=0.5)
    assert (found["cost"], found["seconds"] >= 2.1) == (1.0, True)
    assert time.monotonic() - began < 4.2


def test_one_that_hangs_is_a_timeout_once(folder: Path, systems: Systems, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cases, "LONGEST", 0.7)
    assert ask(systems, a=0.2)["status"] == "ok"
    began = time.monotonic()
    found = ask(systems, a=0.5)
    assert (found["status"], found["reason"], found["untraced"]) == ("timeout", "no answer within 0.7 s", "")
    assert found["seconds"] <= time.monotonic() - began < 1.9, "it is not evaluated a second time"


def test_with_repeats_it_is_a_single_call(folder: Path, systems: Systems) -> None:
    describe(folder, trace={}, scene=None)
    simulator = {"name": "asked", "repeats": {"count": 5}, "retries": 2}
    found = ask(systems, CAMPAIGN | {"simulator": simulator}, a=0.2)
    assert (found["cost"], found["columns"], found["untraced"]) == (0.4, [], "")


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"a": 2.0}, "simulator.a must be within 0 to 1"),
        ({"a": "x"}, "simulator.a must be a number, given 'x'"),
        ({"b": 0.1}, "the simulator has no parameter 'simulator.b'"),
        ({"simulator": "asked@0123456789abcdef"}, "it has other parameters or results than for this run"),
        ({"campaign": CAMPAIGN | {"simulator": {"name": "gone"}}}, "the machine of the service has no such simulator"),
        ({"campaign": {"name": "nothing"}}, "the campaign of a case"),
    ],
)
def test_what_cannot_be_evaluated_is_refused_in_words(
    folder: Path, systems: Systems, given: dict[str, Any], reason: str
) -> None:
    assert reason in ask(systems, **given)["error"]


@pytest.mark.parametrize(
    ("simulator", "name", "reason"),
    [
        ("", "asked", ""),
        ("asked@0123456789abcdef", "asked", "it has other parameters or results than for this run"),
        ("", "gone", "the machine of the service has no such simulator; start the service with the same"),
    ],
)
def test_whether_it_is_installed_is_found_out_without_an_evaluation(
    folder: Path, systems: Systems, simulator: str, name: str, reason: str
) -> None:
    campaign = CAMPAIGN | {"simulator": {"name": name}}
    request = {"id": 1, "kind": "installed", "campaign": campaign, "simulator": simulator}
    found = answer(json.dumps(request), systems)
    assert found.keys() == {"id", "missing"}
    assert reason in found["missing"]
    assert bool(found["missing"]) == bool(reason)
    assert systems == {}


def test_an_unreadable_request_is_an_error(systems: Systems) -> None:
    assert "invalid request" in answer(b"{", systems)["error"]
    assert "id must be" in answer(b'{"id": null}', systems)["error"]


def test_a_change_of_the_descriptor_shows_with_the_next_simulator(folder: Path, systems: Systems) -> None:
    before = ask(systems, a=0.2)["identity"]["files"]
    describe(folder, text="Another text")
    close(systems)
    after = ask(systems, a=0.2)["identity"]["files"]
    assert after.keys() == before.keys()
    assert after != before
    assert cases.IDLE > 0
