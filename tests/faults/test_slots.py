"""Whatever a simulator does costs one evaluation: a status with a reason, no other evaluation and no slot lost."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import yaml

from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from clearance.local.failures import OUTPUT
from tests.faults.processes import REPOSITORY, until
from tests.simulators import misbehaving
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.slots import files
from worker.engine.systems.simulators.slots import pool as pool_module
from worker.engine.systems.simulators.slots.outcome import Limits
from worker.engine.systems.simulators.slots.pool import SlotPool
from worker.engine.systems.simulators.slots.program import Program

MARK = "86399.125"
"""How long the grandchild sleeps [s]; found by it."""

EXPECTED = {
    "segfault": (FAILED, "killed by SIGSEGV"),
    "hang": (TIMEOUT, "no answer within 4 s"),
    "spin": (TIMEOUT, "no answer within 4 s"),
    "leak": (FAILED, "MemoryError"),
    "exit code": (FAILED, "exit code 3"),
    "killed": (FAILED, "killed by SIGKILL"),
    "not a number": (FAILED, "its result d is nan, not a finite number"),
    "infinite": (FAILED, "its result d is inf, not a finite number"),
    "missing key": (FAILED, "its results lack d; it returned e"),
    "wrong type": (FAILED, "its result d is 'near', not a number"),
    "boolean": (FAILED, "its result d is True, not a number"),
    "no object": (FAILED, "its answer has no object `results`"),
    "long answer": (FAILED, "its answer is longer than 16000000 bytes"),
    "nan as C writes it": (
        FAILED,
        'its answer is not JSON (Expecting value: line 1 column 19 (char 18)): {"results": {',
    ),
    "inf as C writes it": (FAILED, '{"results": {"d": -inf}}'),
    "single quotes": (FAILED, "{'results': {'d': 1.0}}"),
    "cut off": (FAILED, "its answer is not JSON"),
    "an error cut off": (FAILED, "its answer is not JSON"),
    "not UTF-8": (FAILED, "its answer is not JSON"),
    "results nested too deeply": (FAILED, "its answer is not JSON (nested too deeply)"),
    "two in a line": (FAILED, "its answer is not JSON"),
    "a result twice": (FAILED, "its answer states 'd' twice"),
    "results twice": (FAILED, "its answer states 'results' twice"),
    "a log line in braces": (OK, ""),
    "error": (FAILED, "division by zero"),
    "excluded": (EXCLUDED, "starts inside the zone"),
    "excluded without a reason": (FAILED, "its answer has excluded True; the reason in words is expected"),
    "excluded with results": (FAILED, "its answer has both `results` and `excluded`"),
    "excluded with an error": (FAILED, "no licence"),
    "not excluded": (OK, ""),
    "grandchild": (FAILED, "exit code 3"),
    "early end": (FAILED, "exit code 0"),
    "100 MB of output": (OK, ""),
    "garbage": (OK, ""),
    "deeply nested": (OK, ""),
}
"""What the user sees, by what the simulator does."""


@pytest.fixture(scope="module")
def simulator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CommandSimulator]:
    folder = tmp_path_factory.mktemp("misbehaving")
    described = {
        "name": "misbehaving",
        "command": [sys.executable, str(Path(misbehaving.__file__))],
        "parameters": {"do": {"nominal": 0, "low": 0, "high": 100}},
        "results": {"d": {"unit": "m"}},
        "timeout": 4,
        "memory": 400_000_000,
        "slots": 2,
        "environment": {"MARK": MARK},
    }
    (folder / "simulator.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    opened = CommandSimulator(read(folder), Opening({"simulator.do": 0.0}, "d"))
    yield opened
    opened.close()


def points(*acts: str) -> Any:
    return np.array([[float(list(misbehaving.ACTS).index(act))] for act in acts])


@pytest.mark.by_day(10)
@pytest.mark.parametrize(
    "act",
    # By day one that sleeps past its time; this one computes until then.
    [pytest.param(act, marks=[pytest.mark.nightly] if act == "spin" else []) for act in EXPECTED],
)
def test_it_costs_one_evaluation(simulator: CommandSimulator, act: str) -> None:
    status, reason = EXPECTED[act]
    batch, reasons = simulator.evaluate(points("right", act, "right", "right"))
    assert batch.status.tolist() == [OK, status, OK, OK]
    assert batch.costs[[0, 2, 3], 0].tolist() == [1.5] * 3
    assert np.isnan(batch.costs[1, 0]) == (status != OK)
    assert reason in reasons.get(1, "")
    if act in ("segfault", "exit code", "killed", "hang"):
        assert reasons[1].endswith(f"{OUTPUT}working on {act}")


def test_every_act_is_in_the_table() -> None:
    assert {*EXPECTED, "right"} == set(misbehaving.ACTS)


ANSWERS = """import json, sys
for number, line in enumerate(sys.stdin):
    found = json.loads(line).get("id", 0)
    answer = WRITTEN.replace("ID", str(found)) if number == 1 else '"id": %d, "results": {"d": 1.0}' % found
    print("{" + answer + "}", flush=True)
"""


@pytest.mark.parametrize(
    ("written", "reason", "replaced"),
    [
        ('"id": ID, "results": {"d": nan}', "is not JSON", 0),
        ('"id": ID, "results": {"d": 1.0, "d": 2.0}', "states 'd' twice", 0),
        ('"results": {"d": nan}', "has no id", 1),
        ('"id": 99, "results": {"d": nan}', "has the id 99", 1),
    ],
)
@pytest.mark.parametrize("ids", [True, False])
def test_an_answer_that_cannot_be_read_takes_no_time_and_no_process(
    written: str, reason: str, replaced: int, ids: bool
) -> None:
    program = Program([sys.executable, "-c", f"WRITTEN = {written!r}\n{ANSWERS}"], "lines", ids=ids)
    with SlotPool(program, 1, Limits(timeout=600.0)) as pool:
        outcomes = pool.evaluate([{"parameters": {}}] * 3)
        assert [one.kind == "ok" for one in outcomes] == [True, False, True]
        assert (reason if ids or not replaced else "is not JSON") in outcomes[1].reason
        assert "twice" in outcomes[1].reason or '{"d": nan}' in outcomes[1].reason
        assert pool.starts == 1 + (replaced if ids else 0)


def test_what_it_started_is_killed_with_it(simulator: CommandSimulator) -> None:
    simulator.evaluate(points("grandchild"))
    until(lambda: not sleeping(), "what was killed is gone", 20)


def sleeping() -> list[str]:
    found = []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path("/proc", entry, "cmdline").read_bytes()
        except OSError:
            continue
        if MARK.encode() in command:
            found.append(entry)
    return found


def test_a_program_that_never_starts_ends_every_evaluation_with_its_words() -> None:
    with SlotPool(Program(["/no/such/program"], "lines"), 2) as pool:
        outcomes = pool.evaluate([{"parameters": {}}] * 5)
    assert {o.kind for o in outcomes} <= {"crash", "not started"}
    assert all("exit code 127" in o.reason for o in outcomes)
    assert all("/no/such/program " in o.output for o in outcomes)


@pytest.mark.parametrize("protocol", ["lines", "framed"])
def test_a_program_that_never_starts_is_not_started_again_without_work(protocol: Literal["lines", "framed"]) -> None:
    command = ["/no/such/program"] if protocol == "lines" else [sys.executable, str(files.CHILD), "nowhere:f"]
    with SlotPool(Program(command, protocol), 2) as pool:
        outcomes = pool.evaluate([{"parameters": {}}] * 3)
        assert all(o.kind in ("crash", "not started") for o in outcomes)
        until(lambda: len(pool._vacant) == 2, "both slots wait for work", 20)
        assert pool.starts <= 2 + 3 + 2


def test_a_pool_that_cannot_start_a_process_gives_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(pool_module, "Slot", full)
    with SlotPool(Program(["true"], "lines"), 1) as pool:
        until(lambda: refused(pool), "a refusal", 20)


def refused(pool: SlotPool) -> bool:
    """Whether it takes no more requests; one that it took is answered, with the reason in either case."""
    try:
        future = pool.submit({"parameters": {}})
    except RuntimeError as error:
        reason, closed = str(error), True
    else:
        reason, closed = future.result(timeout=10).reason, False
    assert os.strerror(errno.EMFILE) in reason
    return closed


def test_it_may_be_closed_twice_and_by_many() -> None:
    pool = SlotPool(Program([sys.executable, "-c", "import time; time.sleep(1e6)"], "lines"), 1)
    with ThreadPoolExecutor(4) as threads:
        list(threads.map(lambda _: pool.close(), range(8)))
    pool.close()


def framed(tmp_path: Path, text: str, slots: int, limits: Limits) -> SlotPool:
    """A pool around a function `f` of this text."""
    file = tmp_path / "function.py"
    file.write_text(text, encoding="utf-8")
    return SlotPool(Program([sys.executable, str(files.CHILD), f"{file}:f"], "framed"), slots, limits)


def test_a_process_killed_from_outside_loses_nothing(tmp_path: Path) -> None:
    """Of a function of Python it is known what it has begun: a process that dies between evaluations blames none."""
    with framed(tmp_path, "import os\ndef f(x):\n    return [x, os.getpid()]\n", 1, Limits(timeout=20)) as pool:
        for k in range(10):
            (outcome,) = pool.evaluate([{"parameters": {"x": k}}])
            assert outcome.kind == "ok", outcome
            os.kill(outcome.answer["results"][1], signal.SIGKILL)
        assert pool.starts >= 10


def test_results_arrive_for_the_point_that_was_asked(tmp_path: Path) -> None:
    with framed(tmp_path, "def f(x):\n    return 2 * x\n", 3, Limits(timeout=20)) as pool:
        outcomes = pool.evaluate([{"parameters": {"x": k}} for k in range(2000)])
    assert [o.answer["results"] for o in outcomes] == [2 * k for k in range(2000)]


def test_a_process_is_replaced_after_its_number_of_evaluations(tmp_path: Path) -> None:
    with framed(tmp_path, "import os\ndef f():\n    return os.getpid()\n", 1, Limits(timeout=20, recycle=3)) as pool:
        pids = [o.answer["results"] for o in pool.evaluate([{"parameters": {}}] * 9)]
    assert [pids.count(p) for p in dict.fromkeys(pids)] == [3, 3, 3]


def test_a_process_of_json_lines_that_replaced_another_gets_what_waits(tmp_path: Path) -> None:
    """It is ready at once, so no event wakes the pool."""
    text = "import json, os, sys\nfor line in sys.stdin: print(json.dumps({'results': os.getpid()}), flush=True)"
    program = Program([sys.executable, "-c", text], "lines", folder=str(tmp_path / "work"))
    with SlotPool(program, 1, Limits(timeout=20, recycle=1)) as pool:
        futures = [pool.submit({"parameters": {}}) for _ in range(4)]
        pids = [f.result(timeout=60).answer["results"] for f in futures]
    assert len(set(pids)) == 4


def test_every_slot_has_its_own_folder_and_number(tmp_path: Path) -> None:
    text = (
        "import json, os, sys\n"
        "for line in sys.stdin: print(json.dumps({'results': [os.getcwd(), sys.argv[1]]}), flush=True)"
    )
    program = Program([sys.executable, "-c", text, "{slot}"], "lines", folder=str(tmp_path / "work" / "{slot}"))
    with SlotPool(program, 2) as pool:
        found = {tuple(o.answer["results"]) for o in pool.evaluate([{"parameters": {}}] * 50)}
    assert found <= {(str(tmp_path / "work" / k), k) for k in "01"}


def test_closing_answers_what_waits() -> None:
    pool = SlotPool(Program([sys.executable, "-c", "import time; time.sleep(1e6)"], "lines"), 1)
    futures = [pool.submit({"parameters": {}}) for _ in range(3)]
    pool.close()
    assert [f.result(timeout=10).reason for f in futures] == ["cancelled"] * 3
    with pytest.raises(RuntimeError, match="closed"):
        pool.submit({"parameters": {}})


def test_no_process_outlives_the_one_that_owns_the_slots(tmp_path: Path) -> None:
    text = (
        "import json,sys,time\nfrom worker.engine.systems.simulators.slots.pool import SlotPool\n"
        "from worker.engine.systems.simulators.slots.program import Program\n"
        f"p=SlotPool(Program([sys.executable,'-c','import time; time.sleep({MARK})'],'lines'),2)\n"
        "p.submit({}); print('up',flush=True); time.sleep(1e6)\n"
    )
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, cwd=REPOSITORY) as owner:
        assert owner.stdout is not None
        assert owner.stdout.readline() == b"up\n"
        until(lambda: len(sleeping()) >= 2, "both slots", 20)
        owner.kill()
    until(lambda: not sleeping(), "no slot is left", 20)


def test_json_keeps_every_bit() -> None:
    numbers = np.random.default_rng(1).normal(size=1000) * 10.0 ** np.arange(-300, 300, 0.6)
    assert json.loads(json.dumps(numbers.tolist())) == numbers.tolist()
