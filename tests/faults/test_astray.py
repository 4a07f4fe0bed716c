"""Answers that are not those of the request, files that change during a run, and what hides from its slot.

Results must never be those of another point without a sentence, and nothing outlives its slot.
"""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import yaml

from campaigns.results.base import FAILED, OK
from tests.faults.processes import until
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared import unchanged
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.pool import NEVER, SlotPool
from worker.engine.systems.simulators.slots.program import Program, identified, line, misidentified

BEGIN = """
import json, os, subprocess, sys, threading, time

def answer(line):
    request = json.loads(line)
    same = {"id": request["id"]} if "id" in request else {}
    return json.dumps({**same, "results": {"d": request["parameters"]["x"]}})
"""
MARK = "86398.375"
"""How long a process sleeps [s]; found by it."""


@contextmanager
def speaking(tmp_path: Path, body: str, timeout: float = 10.0, ids: bool = False) -> Iterator[SlotPool]:
    """A process of JSON lines whose program ends with `body`; ids: its requests have them."""
    file = tmp_path / "program.py"
    file.write_text(BEGIN + textwrap.dedent(body), encoding="utf-8")
    with SlotPool(Program([sys.executable, str(file)], "lines", ids=ids), 1, Limits(timeout=timeout)) as pool:
        yield pool


def values(pool: SlotPool, count: int) -> list[Outcome]:
    return pool.evaluate([{"parameters": {"x": float(x)}} for x in range(count)])


def none_is_of_another_point(outcomes: list[Outcome]) -> bool:
    known = [(x, o.answer["results"]["d"]) for x, o in enumerate(outcomes) if o.answer and "results" in o.answer]
    return all(x == d for x, d in known)


@pytest.mark.parametrize("separately", [False, True])
def test_two_answers_to_a_request_are_reported(tmp_path: Path, separately: bool) -> None:
    """Written at once they fail the request; one after the other, the next request."""
    once = "print(answer(line), flush=True)"
    body = f"{once}; {once}" if separately else "os.write(1, f'{answer(line)}\\n{answer(line)}\\n'.encode())"
    with speaking(tmp_path, f"for line in sys.stdin: {body}") as pool:
        outcomes = values(pool, 6)
    assert none_is_of_another_point(outcomes)
    reasons = [o.reason for o in outcomes]
    if not separately:
        assert set(reasons) == {"it wrote 2 JSON objects in answer to 1 request"}
    assert sum(reason.startswith(UNASKED) or "2 JSON objects" in reason for reason in reasons) >= 3


UNASKED = "its process wrote an answer that nothing had asked for"


@pytest.mark.parametrize(
    ("ids", "reason"),
    [
        (False, f"{UNASKED}: earlier results may be those of other points"),
        (True, f"{UNASKED}; no result is affected, as each has its request's id"),
    ],
)
def test_an_answer_that_nothing_asked_for_is_reported(tmp_path: Path, ids: bool, reason: str) -> None:
    told = tmp_path / "told"
    later = f"""
    for line in sys.stdin:
        print(answer(line), flush=True)
        while "0.0" in line and not os.path.exists({str(told)!r}):
            time.sleep(0.01)
        "0.0" in line and print(answer(line), flush=True)
    """
    with speaking(tmp_path, later, timeout=60.0, ids=ids) as pool:
        (first,) = values(pool, 1)
        told.touch()
        until(lambda: pool._unasked, "the second answer has arrived", 60)
        next_one, after = pool.evaluate([{"parameters": {"x": x}} for x in (1.0, 2.0)])
    assert first.kind == "ok"
    assert next_one.reason == reason
    assert after.kind == "ok"


LATE = """
before = None
for line in sys.stdin:
    print(answer(before or line), flush=True)
    before = line
"""
"""Answers each request of a process with the result of the one before it, but for the first."""


def test_a_late_answer_is_taken_for_the_next_one_unless_requests_have_ids(tmp_path: Path) -> None:
    with speaking(tmp_path, LATE, timeout=60.0) as pool:
        shifted = values(pool, 4)
    assert [o.answer["results"]["d"] for o in shifted] == [0.0, 0.0, 1.0, 2.0], "what ids are for"
    with speaking(tmp_path, LATE, timeout=60.0, ids=True) as pool:
        outcomes = values(pool, 4)
        assert pool.starts >= 2, "the process is replaced"
    assert none_is_of_another_point(outcomes)
    assert [o.kind for o in outcomes] == ["ok", "wrong answer", "ok", "wrong answer"]
    assert [o.reason for o in outcomes[1::2]] == [misidentified({"id": number - 1}, number) for number in (2, 4)]


def test_an_answer_without_the_id_of_its_request_is_refused(tmp_path: Path) -> None:
    with speaking(tmp_path, 'for line in sys.stdin: print(\'{"results": {"d": 0}}\', flush=True)', ids=True) as pool:
        outcomes = values(pool, 2)
    assert [o.reason for o in outcomes] == [misidentified({}, number) for number in (1, 2)]


def test_ids_fit_answers_that_are_requested_ahead_and_errors(tmp_path: Path) -> None:
    mixed = """
    for line in sys.stdin:
        request = json.loads(line)
        odd = request["parameters"]["x"] % 2 == 1
        print(json.dumps({"id": request["id"], "error": "odd"}) if odd else answer(line), flush=True)
    """
    with speaking(tmp_path, mixed, timeout=60.0, ids=True) as pool:
        outcomes = values(pool, 200)
    assert none_is_of_another_point(outcomes)
    assert [o.reason or o.kind for o in outcomes] == ["ok", "odd"] * 100


@pytest.mark.parametrize("same", [17, 17.0])
def test_the_same_number_is_the_same_id(same: object) -> None:
    assert misidentified({"id": same}, 17) == ""


@pytest.mark.parametrize("other", [16, 0, -17, 17.5, "17", True, [17], {"id": 17}, 10**400, float("nan"), "x" * 10**6])
def test_anything_else_is_another_id_and_a_short_sentence(other: object) -> None:
    statement = misidentified({"id": other}, 17)
    assert "and the request has 17" in statement
    assert len(statement) < 200


@pytest.mark.parametrize("answer", [{}, {"id": None}, {"results": {"id": 17}}, [], 17, None])
def test_what_has_no_id_is_no_answer_of_a_request_with_one(answer: object) -> None:
    assert "has no id" in misidentified(answer, 17)


def test_true_is_not_the_first_request() -> None:
    assert misidentified({"id": True}, 1)


def test_without_ids_a_request_is_what_it_was(tmp_path: Path) -> None:
    """A program may refuse keys that it does not know."""
    strict = "for line in sys.stdin: print(answer(line) if list(json.loads(line)) == ['parameters'] else 0, flush=True)"
    with speaking(tmp_path, strict) as pool:
        assert [o.kind for o in values(pool, 3)] == ["ok"] * 3


def test_the_id_comes_first_in_the_line() -> None:
    """A program that searches the text for `"id":` finds no parameter of that name before it."""
    assert line(identified({"parameters": {"id": 0.5}, "trace": True}, 3)) == (
        b'{"id": 3, "parameters": {"id": 0.5}, "trace": true}\n'
    )


@pytest.mark.parametrize("pause", [0.0, 0.02])
def test_an_object_that_is_no_answer_shifts_no_result(tmp_path: Path, pause: float) -> None:
    """A program that logs JSON on standard output."""
    logs = f"""
    for line in sys.stdin:
        print(json.dumps({{"level": "info"}}), flush=True)
        time.sleep({pause})
        print(answer(line), flush=True)
    """
    with speaking(tmp_path, logs) as pool:
        outcomes = values(pool, 4)
    assert none_is_of_another_point(outcomes)
    assert not any(o.kind == "ok" and "results" in o.answer for o in outcomes)


def test_an_object_that_is_no_answer_while_nothing_is_asked_is_ordinary_output(tmp_path: Path) -> None:
    greets = f"""
    print(json.dumps({{"level": "ready"}}), flush=True)
    open({str(tmp_path / "ready")!r}, "w").close()
    for line in sys.stdin: print(answer(line), flush=True)
    """
    with speaking(tmp_path, greets) as pool:
        until((tmp_path / "ready").exists, "it has greeted", 10)
        assert [o.kind for o in values(pool, 3)] == ["ok"] * 3


def test_an_answer_that_is_held_back_is_missed(tmp_path: Path) -> None:
    """A program that holds an answer back until it has the next request never answers: one request is sent at first."""
    held = "before = None\nfor line in sys.stdin:\n    before and print(answer(before), flush=True)\n    before = line"
    with speaking(tmp_path, held, timeout=0.6) as pool:
        outcomes = values(pool, 3)
    assert {o.kind for o in outcomes} == {"timeout"}
    assert all(NEVER in o.reason for o in outcomes)


def test_one_that_has_answered_before_is_not_suspected_of_its_buffer(tmp_path: Path) -> None:
    once = "for line in sys.stdin:\n    '0.0' in line and print(answer(line), flush=True)"
    with speaking(tmp_path, once, timeout=5.0) as pool:
        first, second = values(pool, 2)
    assert first.kind == "ok"
    assert second.reason == "no answer within 5 s"


def test_output_of_a_thread_between_answers_is_only_output(tmp_path: Path) -> None:
    """Each answer is written at once; one that is broken up by other output is missed, and never another one."""
    noisy = """
    def chatter():
        while True:
            os.write(1, b"progress 50 %\\n")
            time.sleep(0.0005)
    threading.Thread(target=chatter, daemon=True).start()
    for line in sys.stdin: os.write(1, answer(line).encode() + b"\\n")
    """
    with speaking(tmp_path, noisy) as pool:
        outcomes = values(pool, 200)
    assert none_is_of_another_point(outcomes)
    assert {o.kind for o in outcomes} == {"ok"}


def test_a_daemon_without_the_environment_is_killed_by_the_pipe_that_it_holds(tmp_path: Path) -> None:
    hides = f"""
    for line in sys.stdin:
        subprocess.Popen(["setsid", "-f", "env", "-i", "sleep", "{MARK}"], env={{"PATH": os.environ["PATH"]}})
        time.sleep(0.2)
        os._exit(3)
    """
    with speaking(tmp_path, hides) as pool:
        (outcome,) = values(pool, 1)
        assert "exit code 3" in outcome.reason
        until(lambda: not _sleeping(), "the daemon is gone", 10)


def _sleeping() -> list[str]:
    found = []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path("/proc", entry, "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        found += [entry] if command[:2] == [b"sleep", MARK.encode()] else []
    return found


@pytest.fixture
def simulator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[CommandSimulator]:
    """A program in a folder of its own, whose files are looked at before every evaluation."""
    monkeypatch.setattr(unchanged, "PAUSE", 0.0)
    monkeypatch.setattr(unchanged, "LEISURE", 0.0)
    (tmp_path / "program.py").write_text(BEGIN + "for line in sys.stdin: print(answer(line), flush=True)")
    described = {
        "name": "program",
        "command": [sys.executable, "{folder}/program.py"],
        "parameters": {"x": {"nominal": 0, "low": 0, "high": 1}},
        "results": {"d": {}},
        "slots": 1,
    }
    (tmp_path / "simulator.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    opened = CommandSimulator(read(tmp_path), Opening({"simulator.x": 0.0}, "d"))
    yield opened
    opened.close()


def status(simulator: CommandSimulator) -> tuple[int, str]:
    batch, reasons = simulator.evaluate(np.array([[1.0]]))
    return int(batch.status[0]), reasons.get(0, "")


@pytest.mark.parametrize("how", ["edited", "removed"])
def test_files_that_change_during_a_run_fail_what_follows(
    simulator: CommandSimulator, tmp_path: Path, how: str
) -> None:
    """Also in what is made of it for confirmation, which would take the changed files for its own."""
    assert status(simulator) == (OK, "")
    file = tmp_path / "program.py"
    text = file.read_text()
    file.write_text(text + "\n# faster\n") if how == "edited" else file.unlink()
    expected = (FAILED, "program.py has changed since this run opened it; start the run again")
    assert status(simulator) == expected
    fresh = simulator.fresh()
    assert status(fresh) == expected
    file.write_text(text)
    assert status(simulator) == expected, "it was another one in between"


def test_files_that_only_look_changed_or_are_new_do_not_matter(simulator: CommandSimulator, tmp_path: Path) -> None:
    assert status(simulator) == (OK, "")
    os.utime(tmp_path / "program.py", ns=(1, 1))
    (tmp_path / "log.txt").write_text("written by the program")
    assert status(simulator) == (OK, "")
