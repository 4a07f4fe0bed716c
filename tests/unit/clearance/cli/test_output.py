"""The exit code of a command does not depend on who reads what it prints."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from clearance import cli

COMMAND = [sys.executable, "-P", "-m", "clearance"]


@pytest.mark.nightly
def test_a_pipe_that_is_closed_changes_no_exit_code() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ended = subprocess.run([*COMMAND, "explain", "--help"], stdout=writing, stderr=subprocess.PIPE, text=True)
    os.close(writing)
    assert (ended.returncode, ended.stderr) == (0, "")


@pytest.mark.nightly  # by day a pipe that nobody reads, above
def test_output_that_is_closed_changes_no_exit_code() -> None:
    command = f"{shlex.join([*COMMAND, 'explain', '--help'])} >&-"
    ended = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")


@pytest.mark.nightly
def test_output_that_cannot_be_written_is_stated() -> None:
    with Path("/dev/full").open("w") as full:
        ended = subprocess.run([*COMMAND, "explain", "--help"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert ended.returncode == cli.WRONG_INPUT
    assert "cannot be written" in ended.stderr
    assert "Traceback" not in ended.stderr


@pytest.mark.parametrize("group", ["", "  "])
def test_an_empty_group_is_refused(group: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.invoke(["submit", str(tmp_path / "campaign.yaml"), "--group", group]) == cli.WRONG_INPUT
    assert "--group is empty" in capsys.readouterr().err


def test_more_runs_than_any_service_has_are_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.invoke(["runs", "--limit", "9" * 20]) == cli.WRONG_INPUT
    assert "--limit" in capsys.readouterr().err
