"""The programs of docs/examples, from their descriptors to a verdict on the command line."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from campaigns.results.base import EXCLUDED, FAILED
from clearance.cli import WRONG_INPUT, invoke
from tests.faults.launched import run
from tests.faults.processes import REPOSITORY
from tests.simulators import unrepeatable
from worker.engine.search.base import Batch
from worker.engine.systems.base import Reasons
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.running.catalogue.installed import forget_simulators

EXAMPLES = REPOSITORY / "docs" / "examples"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The examples as an operator installs them, the C program compiled."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    made = tmp_path_factory.mktemp("simulators")
    shutil.copytree(EXAMPLES, made, dirs_exist_ok=True)
    subprocess.run([compiler, "-O2", "-o", made / "drop/drop", made / "drop/drop.c", "-lm"], check=True)
    return made


@pytest.mark.nightly  # by day tests/e2e/test_simulator_run.py runs the same program through the service
def test_a_program_of_json_lines(folder: Path) -> None:
    code, result, errors = run(folder, EXAMPLES / "campaigns" / "drop.yaml")
    assert code == 1, errors
    assert result["verdict"] == "violated"
    assert [s["best"] for s in result["stages"] if s["kind"] == "search"] == pytest.approx([0.0, 0.0], abs=1e-3)
    repeated = result["findings"][0]["validation"]
    assert repeated["again"]["cost"] == repeated["cost"]
    assert repeated["violates"]


def test_a_process_for_each_evaluation(folder: Path) -> None:
    """The closed form: clearance = 0.5 - |v| sqrt(m / k)."""
    described = read(folder / "mass_spring")
    nominal = {f"simulator.{name}": p.nominal for name, p in described.descriptor.parameters.items()}
    simulator = CommandSimulator(described, Opening(nominal, "clearance"))
    vectors = np.array([[m, 100.0, v] for m in (0.5, 2.0) for v in (-2.0, 0.0, 1.0)])
    try:
        batch, reasons = simulator.evaluate(vectors)
    finally:
        simulator.close()
    assert reasons == {}
    assert batch.costs[:, 0] == pytest.approx(0.5 - abs(vectors[:, 2]) * np.sqrt(vectors[:, 0] / 100.0), abs=1e-12)


def evaluated(folder: Path, **described: Any) -> tuple[Batch, Reasons]:
    """The nominal evaluation of a program with one parameter and one result, so described."""
    described["parameters"] = {"a": {"nominal": 0.5, "low": 0, "high": 1}}
    described["results"] = {"d": {"unit": ""}}
    (folder / "simulator.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    simulator = CommandSimulator(read(folder), Opening({"simulator.a": 0.5}, "d"))
    try:
        return simulator.evaluate(simulator.nominal[None, :])
    finally:
        simulator.close()


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("written", "status", "reason"),
    [
        ({"excluded": "starts inside"}, EXCLUDED, "starts inside"),
        ({"excluded": "starts inside", "d": -1.0}, FAILED, "`excluded`"),
        ({"excluded": " "}, FAILED, "Excluded needs"),
    ],
)
def test_a_file_of_results_may_exclude_the_case(tmp_path: Path, written: object, status: int, reason: str) -> None:
    program = f"import json, sys; json.dump({written!r}, open(sys.argv[1], 'w'))"
    command = ["{python}", "-c", program, "{results}"]
    batch, reasons = evaluated(tmp_path, name="excludes", command=command, protocol="files")
    assert batch.status.tolist() == [status]
    assert reason in reasons[0]


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("written", "reason"),
    [
        ('{"d": nan}', "is not JSON"),
        ('{"d": 1.0', "is not JSON"),
        ("", "is not JSON"),
        ('{"d": -5, "d": 50}', "states 'd' twice"),
    ],
)
def test_a_file_of_results_that_cannot_be_read_is_quoted(tmp_path: Path, written: str, reason: str) -> None:
    command = ["{python}", "-c", f"import sys; open(sys.argv[1], 'w').write({written!r})", "{results}"]
    batch, reasons = evaluated(tmp_path, name="unreadable", command=command, protocol="files")
    assert batch.status.tolist() == [FAILED]
    assert reasons[0].startswith(f"results.json {reason}")
    assert "twice" in reasons[0] or written in reasons[0]


def test_python_in_a_command_is_the_interpreter_of_the_worker(tmp_path: Path) -> None:
    program = "import json, sys\nfor _ in sys.stdin: print(json.dumps({'results': {'d': float(same())}}), flush=True)"
    program = f"def same(): return __import__('sys').executable == {sys.executable!r}\n{program}"
    batch, reasons = evaluated(tmp_path, name="interpreter", command=["{python}", "-c", program])
    assert reasons == {}
    assert batch.costs.tolist() == [[1.0]]


def test_a_descriptor_that_is_gone_is_refused_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path))
    forget_simulators()
    try:
        assert invoke(["run", str(EXAMPLES / "campaigns" / "drop.yaml")]) == WRONG_INPUT
    finally:
        forget_simulators()
    assert "simulator.name" in capsys.readouterr().err


@pytest.mark.nightly  # the whole way of two cases of tests/faults/test_noise.py
@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("noise", "set simulator.repeats to {count: "),
        ("now and then", "validation did not confirm it"),
    ],
)
def test_what_does_not_repeat_is_never_cleared(tmp_path: Path, how: str, reason: str) -> None:
    (tmp_path / "one").mkdir()
    described = {
        "name": "unrepeatable",
        "command": [sys.executable, str(Path(unrepeatable.__file__)), how],
        "parameters": {name: {"nominal": 0.5, "low": 0, "high": 1} for name in "ab"},
        "results": {"d": {"unit": "m"}},
    }
    (tmp_path / "one" / "simulator.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    methods = [{"method": name, "evaluations": 300} for name in ("direct", "differential_evolution")]
    campaign = {
        "name": "Unrepeatable",
        "simulator": {"name": "unrepeatable"},
        "uncertain": {f"simulator.{name}": {"low": 0, "high": 1} for name in "ab"},
        "criterion": {"result": "d", "threshold": 1.0},
        "stages": {
            "search": methods,
            "certify": {"samples": 100},
            "validate": {"neighbours": 20, "evaluations": 20_000},
        }
        | {"findings": {"at_most": 2, "evaluations": 400}},
    }
    file = tmp_path / "campaign.yaml"
    file.write_text(yaml.safe_dump(campaign), encoding="utf-8")
    code, result, errors = run(tmp_path, file)
    assert code == 2, errors
    assert reason in result["sentence"] + result["reason"]
