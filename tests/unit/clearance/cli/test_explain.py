"""`clearance explain`: the simulated code, and its file."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

from campaigns import library, load_file
from clearance.cli import WRONG_INPUT, invoke
from clearance.testing.problems import Problem
from tests.simulators.adversaries import adversary
from tests.simulators.noisy import campaign


@pytest.mark.parametrize("name", ["unicycle_static", "uav_aca_latency"])
def test_it_prints_the_text_that_is_simulated(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["explain", name]) == 0
    shown = capsys.readouterr()
    loop = Problem(load_file(library()[name])).system.loop
    assert shown.out == loop.text
    assert "closed_loop" in {node.name for node in ast.parse(shown.out).body if isinstance(node, ast.FunctionDef)}
    file = Path(shown.err.removeprefix("The file to set breakpoints in: ").strip())
    assert file.read_text(encoding="utf-8") == shown.out
    assert loop.part("closed_loop").__code__.co_filename == str(file)
    assert loop.kernel("closed_loop").py_func.__code__.co_filename == str(file)


@pytest.mark.parametrize("name", ["no_such_campaign", "README.md"])
def test_what_is_no_campaign(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["explain", name]) == WRONG_INPUT
    assert name in capsys.readouterr().err


def test_a_simulator_has_no_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "adversary.json"
    file.write_text(json.dumps(campaign().document()), encoding="utf-8")
    with adversary():
        assert invoke(["explain", str(file)]) == WRONG_INPUT
    statement = "Adversary, simulator adversary has no Python code to print; only a closed loop has"
    assert statement in capsys.readouterr().err
