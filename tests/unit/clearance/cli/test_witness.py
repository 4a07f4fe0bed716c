"""Code that ends the process of a command: whatever its exit code, it is not taken for a result."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from clearance.cli import INTERNAL, VIOLATED, _witness, invoke
from tests.simulators import package
from worker.running.catalogue import installed

BEGIN = """
import ctypes, os, runpy, signal, sys
signal.signal(signal.SIGHUP, signal.SIG_{})
witness = runpy.run_path(sys.argv[1])["witnessed"](4)
"""
"""The file alone: its package takes half a second of processor time in each process."""
REPORT = "witness.report({0}); sys.exit({0})"
ENDINGS = {
    "os._exit(0)": INTERNAL,
    "os._exit(1)": INTERNAL,
    "sys.exit(0)": INTERNAL,
    "ctypes.CDLL(None).exit(0)": INTERNAL,
    "ctypes.CDLL(None)._exit(2)": INTERNAL,
    "witness.report(1); os._exit(0)": INTERNAL,
    "os.fork() or (signal.alarm(2), os.closerange(0, 3), signal.pause())\nos._exit(0)": INTERNAL,
    REPORT.format(0): 0,
    REPORT.format(1): VIOLATED,
    REPORT.format(130): 130,
    "os.kill(os.getpid(), signal.SIGKILL)": -signal.SIGKILL,
    "os.kill(os.getpid(), signal.SIGSEGV)": -signal.SIGSEGV,
    "os.kill(os.getppid(), signal.SIGTERM); signal.pause()": -signal.SIGTERM,
    "os.kill(os.getppid(), signal.SIGHUP); signal.pause()": -signal.SIGHUP,
}

SIMULATOR = """
import ctypes, os
import clearance

calls = 0

@clearance.simulator(parameters={"a": (-1.0, 1.0)}, results={"d": clearance.Output(unit="m")}, isolated=False)
def stops(a):
    global calls
    calls += 1
    if os.environ["ENDS"] and calls > 2:
        ctypes.CDLL(None).exit(0)  # as `stop` of Fortran does
    return 1.0 - a
"""


def begun(hangup: str, body: str) -> list[str]:
    """A command in a child, which does this. hangup: DFL, or IGN as under nohup."""
    return [sys.executable, "-c", BEGIN.format(hangup) + body, str(_witness.__file__)]


@pytest.mark.by_day(5)
@pytest.mark.parametrize(("body", "code"), ENDINGS.items())
def test_only_a_reported_code_is_that_of_the_command(body: str, code: int) -> None:
    ended = subprocess.run(begun("DFL", body), capture_output=True, text=True, check=False)
    assert ended.returncode == code
    assert bool(ended.stderr) == (code == INTERNAL), ended.stderr


def test_under_nohup_a_closed_terminal_ends_nothing() -> None:
    body = "os.kill(os.getppid(), signal.SIGHUP); " + REPORT.format(VIOLATED)
    assert subprocess.run(begun("IGN", body), check=False).returncode == VIOLATED


def test_the_child_ends_with_its_parent() -> None:
    body = "print(os.getpid(), flush=True); signal.pause()"
    with subprocess.Popen(begun("DFL", body), stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        child = os.pidfd_open(int(parent.stdout.readline()))
        parent.kill()
        assert parent.stdout.read() == "", "its end of the output is closed"
        os.close(child)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign of a simulator that runs in the process, and the results of its run."""
    folder = tmp_path_factory.mktemp("ends")
    (folder / "sims").mkdir()
    (folder / "sims" / "stops.py").write_text(SIMULATOR, encoding="utf-8")
    stages = {"sensitivity": None, "search": [{"method": "direct", "evaluations": 8}], "validate": {"neighbours": 0}}
    document = package.campaign(
        simulator={"name": "stops"}, uncertain={"simulator.a": {"low": -1.0, "high": 1.0}},
        criterion={"result": "d", "threshold": 0.5}, stages=stages,
    )  # fmt: skip
    (folder / "campaign.json").write_text(json.dumps(document), encoding="utf-8")
    assert command(folder, "run", "campaign.json", "--out", "out") == VIOLATED
    return folder


def command(folder: Path, *words: str, ends: str = "") -> int:
    settings = {"CLEARANCE_SIMULATORS": str(folder / "sims"), "ENDS": ends}
    ended = subprocess.run(
        [sys.executable, "-P", "-m", "clearance", *words], cwd=folder, env=os.environ | settings, check=False
    )
    return ended.returncode


@pytest.mark.nightly  # by day the endings of any child, above, and a method that calls sys.exit
@pytest.mark.parametrize(
    "words",
    [
        ("run", "campaign.json"),
        ("check-simulator", "stops"),
        ("replay", "out", "F1", "1:0", "1:1", "1:2"),
        ("audit", "out", "--replay", "5"),
    ],
    ids=lambda words: words[0],
)
def test_code_that_ends_the_process_leaves_no_result(folder: Path, words: tuple[str, ...]) -> None:
    assert command(folder, *words, ends="1") == INTERNAL


def test_a_method_that_calls_sys_exit_leaves_no_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def search(*_: Any, **__: Any) -> None:
        sys.exit(0)

    methods = installed.methods()
    monkeypatch.setitem(methods, "direct", replace(methods["direct"], search=search))
    assert invoke(["run", "unicycle_static", "--junit", str(tmp_path / "j.xml")]) == INTERNAL
    assert "no verdict" in (tmp_path / "j.xml").read_text(encoding="utf-8")
