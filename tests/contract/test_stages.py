"""The contract of all stages: declared, named by a plan, with a storable result."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import ValidationError

from campaigns.stages.declared import Declared
from campaigns.stages.found import declared, stage_result
from campaigns.stages.plan import plan
from tests.faults.processes import REPOSITORY
from tests.given.case_campaigns import campaign
from tests.simulators import package
from worker.engine.stages.found import stages

ASKED: dict[str, Any] = {
    "sensitivity": {"points": 3},
    "search": [{"method": "direct", "evaluations": 1}],
    "certify": {"samples": 1},
    "estimate": {"evaluations": 1000},
    "attraction": {},
}
BASELINE = {
    "run": "R-0001",
    "digest": "0" * 64,
    "threshold": 0.5,
    "cases": [{"label": "F1", "parameters": {"vehicle.m": 6.0, "vehicle.J": 0.06}, "cost": 0.94}],
}
EACH = pytest.mark.parametrize("stage", declared().values(), ids=lambda s: s.kind)


@EACH
def test_a_plan_can_name_it(stage: Declared) -> None:
    assert stage.kind in {planned.kind for planned in plan(campaign(stages=ASKED, baseline=BASELINE))}


@EACH
def test_it_has_a_title_and_describes_itself_in_a_few_words(stage: Declared) -> None:
    assert stage.title
    assert 0 < len(stage.description(campaign(stages=ASKED, baseline=BASELINE))) < 60


@EACH
def test_its_result_names_its_stage(stage: Declared) -> None:
    field = stage.result.model_fields["stage"]
    assert get_args(field.annotation) == (stage.kind,)
    assert field.default == stage.kind, "the worker need not give it"


@EACH
def test_its_result_is_read_as_its_own_type(stage: Declared) -> None:
    with pytest.raises(ValidationError) as refused:
        stage_result({"stage": stage.kind})
    assert {error["loc"][0] for error in refused.value.errors()} == {stage.kind}, "only its own fields are missing"


def test_every_stage_that_is_declared_can_be_run_and_no_other() -> None:
    assert list(declared()) == [
        planned.kind for planned in dict.fromkeys(plan(campaign(stages=ASKED, baseline=BASELINE)))
    ]
    assert stages().keys() == declared().keys()


DECLARED = '''
from typing import Literal
from campaigns.results.stage import StageResult
from campaigns.stages.declared import Declared

class CornerResult(StageResult):
    """The lowest corner of the ranges."""
    stage: Literal["corners"] = "corners"
    lowest: float | None

stage = Declared("corners", 1.5, "Corners", CornerResult,
                 lambda campaign: [(None, 2 ** len(campaign.uncertain))], lambda campaign: "every corner of the ranges")
'''
RUN = """
import itertools
import numpy as np
from campaigns.stages.corners import CornerResult
from worker.engine.stages.parts.base import drive, once
from worker.engine.stages.parts.outcome import Outcome, Stage

def run(context, position):
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=context.problem.dimension)))
    driven = drive(context, position, once(corners, "every corner"), len(corners) + 1)
    return Outcome(CornerResult(lowest=driven.tally.best))

stage = Stage("corners", run)
"""


ALL = """
import sys
from clearance.cli import invoke

file, out = sys.argv[1:]
assert invoke(["run", file, "--out", out]) == 1
assert invoke(["audit", out]) == 0
"""
"""In one process, which takes seconds to start."""


def with_corners(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """A process of a product that has a further stage."""
    source = folder / "source"
    for room in ("backend", "campaigns", "clearance", "tools", "worker"):
        shutil.copytree(REPOSITORY / room, source / room)
    (source / "campaigns" / "stages" / "corners.py").write_text(DECLARED, encoding="utf-8")
    (source / "worker" / "engine" / "stages" / "corners.py").write_text(RUN, encoding="utf-8")
    installed = package.install(folder / "package")
    environment = {**os.environ, "PYTHONPATH": f"{source}{os.pathsep}{installed}"}
    done = subprocess.run(
        [sys.executable, "-c", *command], cwd=source, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.nightly
def test_a_stage_in_two_files_is_planned_run_and_stored(tmp_path: Path) -> None:
    file, out = tmp_path / "basins.json", tmp_path / "out"
    file.write_text(json.dumps(package.campaign()), encoding="utf-8")
    done = with_corners(tmp_path, ALL, str(file), str(out))
    assert [line.partition(":")[0] for line in done.stderr.splitlines()].count("corners") == 1, (
        "one line for each stage"
    )
    stages = json.loads((out / "result.json").read_text(encoding="utf-8"))["stages"]
    assert [stage["kind"] for stage in stages[:4]] == ["nominal", "sensitivity", "corners", "search"]
    assert (stages[2]["evaluations"], stages[2]["best"]) == (4, pytest.approx(7.8, abs=0.1))
    assert "agrees" in done.stdout


@pytest.mark.nightly  # by day the description with the stages of today: tests/contract/test_generated.py
def test_a_stage_in_two_files_is_described_by_the_api(tmp_path: Path) -> None:
    described = json.loads(with_corners(tmp_path, "from tools import openapi; print(openapi.text())").stdout)
    assert "CornerResult" in described["components"]["schemas"]
