"""Python functions from three lines to a verdict: in this process, in slots, and from a file of the operator."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clearance
from campaigns.claims.stages.calls import nominal_excluded
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from clearance.cli import invoke
from tests.faults.processes import REPOSITORY
from tests.simulators import isolated, two_basins
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.functions import Isolated
from worker.evidence.audit import judge
from worker.evidence.audit.record import of_folder
from worker.running.catalogue.files import entry_of
from worker.running.catalogue.installed import forget_simulators
from worker.running.runs.audited import audited

EXPECTED = [
    (OK, ""),
    (FAILED, "its process was killed by SIGSEGV"),
    (TIMEOUT, "no answer within 1 s"),
    (FAILED, "its process ended with exit code 3"),
    (FAILED, "ZeroDivisionError: division by zero, at line"),
    (FAILED, "it returned None; is a return statement missing?"),
    (FAILED, "MemoryError, at line"),
    (FAILED, "it returned nan, not a finite number"),
    (EXCLUDED, "starts inside"),
    (FAILED, "ValueError: Excluded needs the reason in words"),
]
"""By what `isolated.misbehaving` does."""


def command(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "clearance", *arguments], env=os.environ | environment, capture_output=True, text=True,
        check=False, cwd=REPOSITORY, timeout=250,
    )  # fmt: skip


@pytest.fixture(scope="module")
def misbehaving() -> Iterator[Isolated]:
    declaration = isolated.misbehaving.declaration
    place = {"module": isolated.__name__, "name": "misbehaving"}
    opening = Opening({"simulator.do": 0.0}, "value")
    opened = Isolated(place, entry_of(declaration), opening, declaration, "digest")
    yield opened
    opened.close()


@pytest.mark.nightly
def test_whatever_a_function_does_costs_one_evaluation(misbehaving: Isolated) -> None:
    acts = [a for k in range(len(EXPECTED)) for a in (float(k), 0.0)]
    batch, reasons = misbehaving.evaluate(np.array(acts)[:, None])
    assert batch.status[::2].tolist() == [status for status, _ in EXPECTED]
    assert batch.costs[1::2, 0].tolist() == [1.5] * len(EXPECTED)
    for k, (_, reason) in enumerate(EXPECTED):
        assert reason in reasons.get(2 * k, "")


def test_a_function_that_cannot_be_loaded_fails_with_its_reason(tmp_path: Path) -> None:
    (tmp_path / "gone.py").write_text("raise OSError('no licence')")
    declaration = isolated.misbehaving.declaration
    place = {"file": str(tmp_path / "gone.py"), "name": "f"}
    opened = Isolated(place, entry_of(declaration), Opening({"simulator.do": 0.0}, "value"), declaration, "d")
    batch, reasons = opened.evaluate(np.zeros((2, 1)))
    opened.close()
    assert batch.status.tolist() == [FAILED, FAILED]
    assert all("no licence" in reason for reason in reasons.values())


def leaving_out(least: float, **options: Any) -> Any:
    """The search of a function that excludes the cases with a mass below this."""

    def fly(mass: float, drag: float) -> float:
        if mass < least:
            raise clearance.Excluded("airborne")
        return 60.0 - 8.0 * (mass - 1.5) ** 2 - 100.0 * (drag - 0.13) ** 2

    return clearance.search(fly, {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}, threshold=50.0, unit="m", **options)


@pytest.mark.nightly
def test_what_a_function_excludes_is_stated_with_its_reason_and_audited(tmp_path: Path) -> None:
    result = leaving_out(1.53)
    assert result.verdict == "cleared", result.verdict.sentence
    record = of_folder(result.save(tmp_path / "saved"))
    number = int(np.count_nonzero(result.status == "excluded"))
    by = f"{number} “airborne”)"
    assert number
    assert by in result.verdict.sentence
    assert [by in check["text"] for check in record.claims["checks"] if check["name"] == "exclusions"] == [True]
    assert judge.closing(audited(record))[0]
    wrong = [item.name for item in audited(record._replace(exclusions={"too heavy": number})) if item.agrees is False]
    assert wrong == ["words.statement", "words.checks.exclusions"]


def test_a_function_that_excludes_much_clears_nothing(tmp_path: Path) -> None:
    result = leaving_out(1.8, methods={"direct": 20})
    assert result.verdict == "inconclusive"
    record = of_folder(result.save(tmp_path / "saved"))
    assert [check["ok"] for check in record.claims["checks"] if check["name"] == "exclusions"] == [False]


def test_a_function_that_excludes_the_nominal_case_is_refused() -> None:
    with pytest.raises(ValueError, match=re.escape(nominal_excluded("airborne"))):
        leaving_out(2.0)


def test_three_lines_to_a_verdict_that_can_be_audited(tmp_path: Path) -> None:
    def fly(mass: float, drag: float) -> float:
        return 60.0 - 8.0 * (mass - 1.5) ** 2 - 100.0 * (drag - 0.13) ** 2

    result = clearance.search(fly, {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}, threshold=50.0, unit="m")
    assert result.verdict == "cleared", result.verdict.sentence
    assert result.worst is not None
    assert result.worst.parameters == pytest.approx({"mass": 2.3, "drag": 0.2}, abs=1e-6)
    assert result.worst.methods == ("auto",)
    folder = result.save(tmp_path / "saved")
    items = audited(of_folder(folder))
    assert judge.closing(items)[0]
    assert {item.name for item in items if not item.agrees} == {"components"}, "no installation has the function"
    stored = json.loads((folder / "result.json").read_text())
    assert stored["verdict"] == result.verdict
    assert stored["sentence"] == result.verdict.sentence
    assert stored["evaluations"]["stored"] == len(result.costs)
    assert len((folder / "evaluations.csv").read_text().splitlines()) == len(result.costs) + 1


def campaign(tmp_path: Path, name: str, neighbours: int = 20) -> Path:
    document: dict[str, Any] = {
        "name": "Basins",
        "simulator": {"name": name},
        "uncertain": {f"simulator.{p}": {"low": 0.0, "high": 0.95} for p in "xy"},
        "criterion": {"result": "separation", "threshold": 2.0},
        "stages": {
            "search": [{"method": m, "evaluations": 400} for m in ("direct", "cma_es")],
            "findings": {"evaluations": 1000},
            "validate": {"neighbours": neighbours, "evaluations": 20_000},
        },
    }
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps(document))
    return file


SOURCE = f"""
import sys
sys.path.insert(0, {str(REPOSITORY)!r})
import clearance
from tests.simulators.functions import together
from tests.simulators.isolated import PARAMETERS, RESULTS, alone

@clearance.simulator(parameters=PARAMETERS, results=RESULTS, isolated=False, vectorized=True)
def fast(x, y):
    return together(x, y)

@clearance.simulator(parameters=PARAMETERS, results=RESULTS, timeout=20)
def safe(x, y):
    return alone(x, y)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    operated = tmp_path / "simulators"
    operated.mkdir()
    (operated / "basins.py").write_text(SOURCE)
    (operated / "broken.py").write_text("import clearance\nx = = 3")
    return operated


@pytest.mark.nightly
def test_a_file_in_the_operators_folder(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(folder))
    forget_simulators()
    try:
        code = invoke(["run", str(campaign(tmp_path, "fast")), "--json"])
    finally:
        forget_simulators()
    shown = capsys.readouterr()
    assert code == 0, shown.err
    result = json.loads(shown.out)
    assert result["worst"]["cost"] == pytest.approx(
        float(two_basins.separation(np.float64(0.2), np.float64(0.7))), abs=1e-3
    )
    assert " function fast" in result["scope"]
    assert "read_bytes" in result["scope"], "a helper that it imports reads a file, so it is not identified"


@pytest.mark.nightly
def test_a_file_in_slots_gives_the_same_numbers(folder: Path, tmp_path: Path) -> None:
    """Every confirmation is in a new process, so this takes a minute."""
    found = []
    for name in ("fast", "safe"):
        done = command("run", str(campaign(tmp_path, name, 0)), "--json", CLEARANCE_SIMULATORS=str(folder))
        assert done.returncode == 0, done.stderr
        result = json.loads(done.stdout)
        found.append(result)
    assert found[0]["nominal"] == found[1]["nominal"]
    assert found[0]["worst"]["cost"] == pytest.approx(found[1]["worst"]["cost"], abs=1e-9)


@pytest.mark.nightly
def test_a_simulator_that_is_not_there_is_explained(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(folder))
    assert invoke(["run", str(campaign(tmp_path, "slow"))]) == 3
    told = capsys.readouterr().err
    assert "no such simulator" in told
    assert "broken.py: line 2: SyntaxError" in told
