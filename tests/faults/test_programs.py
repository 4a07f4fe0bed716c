"""The programs of docs/examples, from their descriptors to a verdict on the command line."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.faults.processes import REPOSITORY

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
    described = made / "mass_spring" / "simulator.yaml"
    described.write_text(described.read_text().replace("python3", sys.executable))
    return made


def run(folder: Path, campaign: Path) -> tuple[int, Any, str]:
    done = subprocess.run(
        [sys.executable, "-m", "worker.cli", "run", str(campaign), "--json"],
        env=os.environ | {"CLEARANCE_SIMULATORS": str(folder)}, capture_output=True, text=True, check=False,
        cwd=REPOSITORY, timeout=250,
    )  # fmt: skip
    return done.returncode, json.loads(done.stdout) if done.stdout.startswith("{") else None, done.stderr


def test_a_program_of_json_lines(folder: Path) -> None:
    code, result, errors = run(folder, EXAMPLES / "campaigns" / "drop.yaml")
    assert code == 1, errors
    assert result["verdict"]["status"] == "violated"
    worst = result["findings"][0]
    assert worst["cost"] < 1e-3
    assert worst["validation"]["comparisons"][0]["cost"] == pytest.approx(worst["validation"]["cost"], abs=0)


def test_a_process_for_each_evaluation(folder: Path, tmp_path: Path) -> None:
    """The closed form: clearance = 0.5 - |v| sqrt(m / k), lowest at the corners of the largest mass and speed."""
    document = yaml.safe_load((EXAMPLES / "campaigns" / "mass_spring.yaml").read_text())
    document["stages"] = {"search": [{"method": "direct", "evaluations": 30}]}
    file = tmp_path / "campaign.yaml"
    file.write_text(yaml.safe_dump(document))
    code, result, errors = run(folder, file)
    assert code == 2, errors
    nominal = next(stage for stage in result["stages"] if stage["stage"] == "nominal")
    assert nominal["cost"] == pytest.approx(0.4, abs=1e-15)
    found = result["findings"][0]["parameters"]
    expected = 0.5 - abs(found["simulator.velocity"]) * (found["simulator.mass"] / 100.0) ** 0.5
    assert result["findings"][0]["cost"] == pytest.approx(expected, abs=1e-12)


def test_a_descriptor_that_is_gone_is_refused_with_a_sentence(folder: Path, tmp_path: Path) -> None:
    code, _, errors = run(tmp_path, EXAMPLES / "campaigns" / "drop.yaml")
    assert code == 3
    assert "simulator.name" in errors
