"""Known violations of a simulator evaluated by several calls: that its calls violate is no reason against them, and the
audit comes to the same; records of earlier versions are judged by the rules of theirs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SIMULATOR = '''
import math, random
import clearance

@clearance.simulator(
    parameters={"x": clearance.Parameter(0, 1, nominal=0.7, text="x")},
    results={"room": clearance.Output(worse="low")}, isolated=False,
)
def noisy(x):
    """A well, and noise."""
    return 1 - 1.5 * math.exp(-((x - 0.2) ** 2) / 0.02) + random.gauss(0, 0.01)
'''
CAMPAIGN = {
    "name": "noisy",
    "simulator": {"name": "noisy", "repeats": {"count": 3, "combine": "worst"}},
    "uncertain": {"simulator.x": {"low": 0.0, "high": 1.0}},
    "criterion": {"result": "room", "threshold": 0.0},
    "regression": {"fail_on": ["new_violation"]},
    "stages": {
        "search": [{"method": "auto", "evaluations": 300}],
        "validate": {"evaluations": 3000},
        "certify": {"samples": 100},
    },
}


@pytest.mark.nightly
def test_violating_calls_of_known_violations_are_not_held_against_them(tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "noisy.py").write_text(SIMULATOR, encoding="utf-8")
    (tmp_path / "campaign.json").write_text(json.dumps(CAMPAIGN), encoding="utf-8")
    environment = {**os.environ, "CLEARANCE_SIMULATORS": str(tmp_path / "own")}

    def clearance(*words: str) -> int:
        command = [sys.executable, "-P", "-m", "clearance", *words]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True).returncode

    assert clearance("run", "campaign.json", "--out", "first") == 1
    clearance("run", "campaign.json", "--baseline", "first", "--out", "second")
    stated = json.loads((tmp_path / "second" / "result.json").read_text(encoding="utf-8"))
    failing = {check["name"] for check in stated["checks"] if not check["ok"]}
    assert "noise of calls" in failing
    assert "Noise" not in stated["regression"]["text"]
    assert stated["regression"]["accepted"] == (failing <= {"no violation", "noise of calls", "probability"})
    assert clearance("audit", "second") == 0
