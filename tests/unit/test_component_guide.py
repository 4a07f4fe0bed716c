"""The guide on own components: its table is what components declare, its example in space is the files, and flies."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

from worker.catalogue.installed import components
from worker.kernels.component import Controller, Vehicle

REPOSITORY = Path(__file__).parents[2]
GUIDE = (REPOSITORY / "docs" / "your-own-component.md").read_text(encoding="utf-8")
EXAMPLES = REPOSITORY / "docs" / "examples"

FLIES = """
import json, sys
from pathlib import Path
import numpy as np
from campaigns import check
from campaigns.asked.load import load_document, load_file
from worker.catalogue.installed import catalogue, skipped
from worker.opening.opened import closed_loop
from worker.problem.problem import Problem

campaign = load_file(Path(sys.argv[1]))
campaign = load_document(campaign.document() | {"scenario": campaign.document()["scenario"] | {"horizon": 1.0}})
problems = [str(p) for p in check(campaign, catalogue())]
problem = Problem(campaign, closed_loop(campaign, compiled=False, lanes=1))
batch, reasons = problem.evaluate(problem.nominal_point[None])
print(json.dumps([problems, len(skipped()), reasons, float(batch.costs[0, 0]), problem.system.own]))
"""


def test_the_table_of_controllers_is_what_they_declare() -> None:
    lines = GUIDE.partition("| vehicle | dimension |")[2].splitlines()[2:]
    rows = [line for line in lines[: lines.index("")] if line]
    controllers = [c for c in components().values() if isinstance(c, Controller)]
    for vehicle in sorted((c for c in components().values() if isinstance(c, Vehicle)), key=lambda v: v.name):
        fit = sorted((c for c in controllers if vehicle.name in c.fits), key=lambda c: c.name)
        demands = ", ".join(sorted({kind for c in fit for kind in c.command}))
        names = ", ".join(f"`{c.name}`" for c in fit)
        assert rows.pop(0) == f"| `{vehicle.name}` | {vehicle.dimension} | {names} | {demands} |"
    assert rows == []


def test_the_example_in_space_is_the_files_and_flies() -> None:
    shown = re.findall(r"^```(?:py|yml)\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)
    for file in ("components/multirotor.py", "components/multirotor_velocity.py", "campaigns/multirotor.yaml"):
        assert (EXAMPLES / file).read_text(encoding="utf-8") in shown, file
    environment = {**os.environ, "CLEARANCE_COMPONENTS": str(EXAMPLES / "components"), "PYTHONPATH": str(REPOSITORY)}
    command = [sys.executable, "-c", FLIES, str(EXAMPLES / "campaigns" / "multirotor.yaml")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    problems, skipped, reasons, cost, own = json.loads(done.stdout)
    assert (problems, skipped, reasons) == ([], 0, {})
    assert 20.0 < cost < 40.0
    assert own == ["worker.components.own.multirotor", "worker.components.own.multirotor_velocity"]


def test_the_files_of_the_example_are_on_no_path_of_this_repository() -> None:
    assert not {"multirotor", "multirotor_velocity"} & {name for _, name in components()}
    assert sorted(p.name for p in Path(EXAMPLES / "components").glob("*.py")) == [
        "multirotor.py",
        "multirotor_velocity.py",
    ]
