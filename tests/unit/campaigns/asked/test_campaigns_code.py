"""A campaign names a simulator and never contains one: what gives code is refused, with the way that there is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from campaigns.asked.load import CampaignError, load_document
from clearance.cli import invoke
from tests.simulators import package

WAY = "CLEARANCE_SIMULATORS"
GIVEN: dict[str, tuple[Any, str]] = {
    "a command": ({"command": ["sh", "-c", "true"]}, "simulator.command"),
    "a name and a command": ({"name": "drop", "command": "rm -r /"}, "simulator.command"),
    "an FMU": ({"name": "drop", "fmu": "model.fmu"}, "simulator.fmu"),
    "Python": ({"name": "drop", "python": "import os"}, "simulator.python"),
    "a limit": ({"name": "drop", "timeout": 1e9}, "simulator.timeout"),
    "an environment": ({"name": "drop", "environment": {"LD_PRELOAD": "x.so"}}, "simulator.environment"),
    "a text": ("python drop.py", "simulator"),
    "a list": (["python", "drop.py"], "simulator"),
    "a command as the name": ({"name": "python drop.py"}, "simulator.name"),
    "a path as the name": ({"name": "../drop"}, "simulator.name"),
    "a mapping as the name": ({"name": {"command": "x"}}, "simulator.name"),
}


@pytest.mark.parametrize("case", GIVEN)
def test_a_simulator_given_as_code_is_refused_with_how_to_install_one(case: str) -> None:
    given, field = GIVEN[case]
    with pytest.raises(CampaignError) as refused:
        load_document(package.campaign(simulator=given))
    statement = [problem.message for problem in refused.value.problems if problem.field == field]
    assert len(statement) == 1, refused.value
    assert WAY in statement[0]


@pytest.mark.parametrize("changes", [{"code": "1 + 1"}, {"command": ["sh"]}])
def test_code_elsewhere_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(CampaignError) as refused:
        load_document(package.campaign(**changes))
    assert [(p.field, WAY in p.message) for p in refused.value.problems] == [(key, True) for key in changes]


def test_another_unknown_key_is_only_unknown() -> None:
    with pytest.raises(CampaignError) as refused:
        load_document(package.campaign(simulator={"name": "drop", "nmae": 1}, timeout=3))
    assert {p.field for p in refused.value.problems} == {"simulator.nmae", "timeout"}
    assert WAY not in str(refused.value)


def test_the_command_line_prints_the_refusal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "campaign.yaml"
    file.write_text("name: x\nsimulator: {command: [sh, -c, 'touch made']}\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert invoke(["run", str(file)]) == 3
    assert WAY in capsys.readouterr().err.replace("\n", " ")
    assert not (tmp_path / "made").exists()
