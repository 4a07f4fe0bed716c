"""An environment in which numba compiles nothing is refused with a sentence."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from clearance.cli import WRONG_INPUT, invoke
from tests.simulators.package import REPOSITORY
from worker.engine.kernels import jit


@pytest.mark.parametrize(
    ("given", "disabled"), [(None, False), ("", False), ("0", False), ("1", True), ("2", True), ("yes", False)]
)
def test_the_variable_is_read_as_numba_reads_it(
    given: str | None, disabled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(jit.VARIABLE, raising=False)
    if given is not None:
        monkeypatch.setenv(jit.VARIABLE, given)
    assert jit.by_environment() is disabled


@pytest.mark.parametrize("command", [["worker"], ["serve"]])
def test_nothing_is_started(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(jit.VARIABLE, "1")
    assert invoke([*command, "--data", str(tmp_path / "data")]) == WRONG_INPUT
    statement = capsys.readouterr().err
    assert statement.startswith("Error: numba's compiler is switched off, by NUMBA_DISABLE_JIT")
    assert "Unset NUMBA_DISABLE_JIT" in statement
    assert not (tmp_path / "data").exists()


@pytest.mark.nightly
def test_a_campaign_is_refused_and_nothing_is_an_internal_error(tmp_path: Path) -> None:
    """Also by the file that numba reads in the working folder."""
    (tmp_path / ".numba_config.yaml").write_text("disable_jit: 1\n")
    campaign = REPOSITORY / "campaigns" / "library" / "unicycle_static.yaml"
    environment = {name: value for name, value in os.environ.items() if name != jit.VARIABLE}
    done = subprocess.run(
        [sys.executable, "-m", "clearance", "run", str(campaign)], cwd=tmp_path, text=True, capture_output=True,
        env=environment | {"PYTHONPATH": str(REPOSITORY)}, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == WRONG_INPUT, done.stderr
    assert ".numba_config.yaml" in done.stderr
    assert "Traceback" not in done.stderr
