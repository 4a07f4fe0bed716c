"""The templates of the CI guide work: their commands are taken from the page and run against a service."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from campaigns.asked.regression import Policy
from clearance.cli import WRONG_INPUT, invoke
from tests.faults.processes import REPOSITORY
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

PAGE = (REPOSITORY / "docs" / "ci.md").read_text(encoding="utf-8")
POLICY, HOOK, ACTION, GITLAB = (yaml.safe_load(text) for text in re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.M | re.S))
GIVEN = {"campaign": "campaign.yaml", "baseline": ACTION["inputs"]["baseline"]["default"]}
WHERE = {
    "GITHUB_HEAD_REF": "", "GITHUB_REF_NAME": "feature/wider turn", "GITHUB_SHA": "4f2a91c", "GITHUB_RUN_NUMBER": "42",
    "GITHUB_STEP_SUMMARY": "step.md", "CI_DEFAULT_BRANCH": "main", "CI_COMMIT_REF_NAME": "feature/wider turn",
    "CI_COMMIT_SHORT_SHA": "4f2a91c", "CI_PIPELINE_IID": "42",
    "GITHUB_REPOSITORY": "us/robot", "GITHUB_REF": "refs/heads/feature/wider turn", "CI_PROJECT_PATH": "us/robot",
}  # fmt: skip
"""The variables of the CI services."""


def steps() -> dict[str, tuple[str, dict[str, str]]]:
    """The script of each template, and the environment that the template gives it."""
    (submit,) = [step for step in ACTION["runs"]["steps"] if "run" in step]
    given = {key: re.sub(r"\$\{\{ inputs\.(\w+) \}\}", lambda m: GIVEN.get(m[1], ""), value)
             for key, value in submit["env"].items()}  # fmt: skip
    (script,) = GITLAB["clearance"]["script"]
    return {"github": (submit["run"], given), "gitlab": (script, GITLAB["clearance"]["variables"])}


@pytest.mark.parametrize(
    ("template", "summary"),
    [("github", "step.md"), ("gitlab", "clearance/summary.md")],
)
@pytest.mark.nightly  # by day what they call: tests/api/runs/test_submit_ci.py, tests/api/runs/test_submit.py
def test_the_commands_of_a_template_run(service: Service, tmp_path: Path, template: str, summary: str) -> None:
    script, given = steps()[template]
    folder, shim = tmp_path / "checkout", tmp_path / "bin" / "clearance"
    for made in (folder, shim.parent):
        made.mkdir()
    shim.write_text(f'#!/bin/sh\nexec {sys.executable} -m clearance "$@"\n')
    shim.chmod(0o755)
    (folder / "campaign.yaml").write_text(yaml.safe_dump(campaign()))
    own = {"CLEARANCE_SERVICE": service.url, "CLEARANCE_TOKEN": service.token(), "PYTHONPATH": str(REPOSITORY)}
    environment = {**os.environ, **WHERE, **given, **own, "PATH": f"{shim.parent}:{os.environ['PATH']}"}
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script]
    job = subprocess.Popen(command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True)
    try:
        until(lambda: service.rows()["runs"] == 1 or job.poll() is not None, 60)
        assert job.poll() is None, job.communicate()[1]
        finish_fully(service, "violated")
        statement = job.communicate(timeout=60)[1]
    finally:
        job.kill()
    assert job.returncode == 1, statement
    with service.signed_in() as client:
        run: dict[str, Any] = client.get("/api/v1/runs/R-0001").json()
    assert run["labels"] == {"branch": "feature/wider turn", "build": "42", "commit": "4f2a91c"}
    assert run["baseline"]["asked"] == "label:branch=main"
    assert run["group"].startswith("us/robot/")
    assert "violated" in (folder / summary).read_text()
    assert (folder / "clearance" / "report.html").exists()
    assert (folder / GITLAB["clearance"]["artifacts"]["reports"]["junit"]).exists()


def test_the_hook_checks_campaign_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (hook,) = yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    assert {"id", "name", "entry", "language", "files"} <= hook.keys()
    (repo,) = HOOK["repos"]
    (used,) = repo["hooks"]
    assert used["id"] == hook["id"]
    for file, checked in (
        ("campaigns/a.yaml", True),
        ("x/campaigns/sub/a.yml", True),
        ("campaign.yaml", True),
        ("robot-campaign.yaml", True),
        ("docker-compose.yml", False),
        ("campaigns/a.py", False),
    ):
        assert bool(re.search(hook["files"], file)) is checked, file
    program, *words = hook["entry"].split()
    assert program == "clearance"
    right = REPOSITORY / "campaigns" / "library" / "unicycle_static.yaml"
    wrong = tmp_path / "campaign.yaml"
    wrong.write_text("name: x\n")
    assert invoke([*words, str(right)]) == 0
    assert invoke([*words, str(right), str(wrong)]) == WRONG_INPUT
    assert "1 of 2 " in capsys.readouterr().err


def test_the_policy_of_the_page_is_one() -> None:
    policy = Policy.model_validate(POLICY["regression"])
    assert (policy.fail_on, policy.tolerance) == (["violation", "new_violation", "worse"], 0.05)
