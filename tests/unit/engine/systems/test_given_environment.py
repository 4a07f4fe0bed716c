"""Linear algebra of our own processes has one thread; programs of others have the environment of their worker."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.slots.given import BEFORE, THREADS, original

PROGRAM = """
import os
from worker.running.processes import blas
import numpy
numpy.ones((400, 400)) @ numpy.ones((400, 400))
from worker.engine.systems.simulators.slots.given import original
print(len(os.listdir("/proc/self/task")), *(
    original(os.environ).get(name, "none") for name in ("OPENBLAS_NUM_THREADS", "ELSE")
))
"""
SIMULATOR = """
import json, os, sys
for line in sys.stdin:
    print(json.dumps({"results": {"d": float(os.environ.get("OPENBLAS_NUM_THREADS", 0))}}), flush=True)
"""


@pytest.mark.parametrize("number", ["3", ""])
def test_a_process_has_one_thread_and_knows_what_was_given(number: str) -> None:
    clean = {name: value for name, value in os.environ.items() if name not in (THREADS, BEFORE)}
    environment = clean | {"ELSE": "x"} | ({THREADS: number} if number else {})
    asked = [sys.executable, "-c", PROGRAM]
    statement = subprocess.run(asked, env=environment, capture_output=True, text=True, check=True).stdout
    assert statement.split() == ["1", number or "none", "x"]


def test_what_was_given_is_known_to_the_processes_of_processes() -> None:
    assert original({THREADS: "1", BEFORE: "8", "A": "b"}) == {THREADS: "8", "A": "b"}
    assert original({THREADS: "1", BEFORE: ""}) == {}
    assert original({THREADS: "4"}) == {THREADS: "4"}  # nothing of ours was set


@pytest.mark.parametrize(("before", "declared", "number"), [("8", {}, 8.0), ("", {}, 0.0), ("8", {THREADS: "2"}, 2.0)])
def test_a_simulator_has_what_was_given_or_what_it_declares(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: str, declared: dict[str, str], number: float
) -> None:
    monkeypatch.setenv(THREADS, "1")
    monkeypatch.setenv(BEFORE, before)
    (tmp_path / "says.py").write_text(SIMULATOR)
    described = {
        "name": "says", "command": [sys.executable, str(tmp_path / "says.py")], "results": {"d": {"unit": "m"}},
        "parameters": {"p": {"nominal": 0, "low": 0, "high": 1}}, "environment": declared,
    }  # fmt: skip
    (tmp_path / "simulator.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    opened = CommandSimulator(read(tmp_path), Opening({"simulator.p": 0.0}, "d"))
    batch, reasons = opened.evaluate(np.zeros((1, 1)))
    opened.close()
    assert reasons == {}
    assert batch.costs[0, 0] == number
