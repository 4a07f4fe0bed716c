"""Ctrl-C at any moment of a command: its exit code, without a traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest
from pydantic_core import SchemaError

from clearance import cli

WHILE_LOADED = """
import importlib.abc, os, runpy, signal, sys


class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == {name!r}:
            os.kill(os.getpid(), signal.SIGINT)


signal.signal(signal.SIGINT, signal.{before})
sys.meta_path.insert(0, Finder())
sys.argv = {argv!r}
runpy.run_module("clearance", run_name="__main__", alter_sys=True)
"""
"""`python -m clearance`, which gets the signal when it is about to load a module."""
FOLLOW = ["clearance", "follow", "R-0001", "--service", "http://127.0.0.1:9", "--patience", "0"]
EARLY = ["worker", "campaigns", "clearance.cli", "sqlalchemy", "pydantic", "typer", "clearance.cli.submit"]
LATE = ["clearance.client", "httpx"]


def ended(name: str, before: str, argv: list[str]) -> subprocess.CompletedProcess[str]:
    code = WHILE_LOADED.format(name=name, before=before, argv=argv)
    environment = os.environ | {"CLEARANCE_TOKEN": "t"}
    return subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, env=environment)


@pytest.mark.by_day(2)
@pytest.mark.parametrize("name", [*EARLY, *LATE])
def test_an_interrupt_while_modules_are_loaded_is_one(name: str) -> None:
    process = ended(name, "default_int_handler", FOLLOW)
    assert (process.returncode, process.stdout, process.stderr) == (cli.INTERRUPTED, "", "interrupted\n")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", [EARLY[0], LATE[0]])
def test_an_interrupt_that_is_ignored_stays_so(name: str) -> None:
    """As in the background of a shell."""
    process = ended(name, "SIG_IGN", FOLLOW)
    assert process.returncode == cli.INTERNAL
    assert "127.0.0.1:9 did not respond" in process.stderr


@pytest.mark.nightly
def test_the_library_installs_no_handler() -> None:
    """Only the module that starts the command does."""
    before = signal.getsignal(signal.SIGINT)
    default = "signal.default_int_handler"  # which a shell that starts tests in the background has replaced
    code = f"import signal; signal.signal(signal.SIGINT, {default}); import clearance.cli; "
    code += f"print(signal.getsignal(signal.SIGINT) is {default})"
    assert subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True).stdout == "True\n"
    assert signal.getsignal(signal.SIGINT) is before


def _chained() -> Exception:
    error = RuntimeError("an error of a library")
    error.__cause__ = KeyboardInterrupt()
    return error


@pytest.mark.parametrize(
    "error", [SchemaError("Error building: KeyboardInterrupt: "), _chained()], ids=["text", "cause"]
)
def test_an_error_in_place_of_an_interrupt_is_one(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> None:
        raise error

    monkeypatch.setattr(cli, "_command", interrupted)
    assert cli.invoke(["runs"]) == cli.INTERRUPTED
    assert capsys.readouterr().err == "interrupted\n"
