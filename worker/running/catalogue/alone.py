"""Runs one of our modules on a file of the operator in a process of its own, where the file may do anything."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any


class NoAnswer(Exception):
    """The process gave no answer; the message states why. overdue: it took too long; started: false if it could not
    be started."""

    def __init__(self, text: str, *, started: bool = True, overdue: bool = False) -> None:
        super().__init__(text)
        self.started, self.overdue = started, overdue


def answer_of(module: str, arguments: list[str], mark: str, environment: Mapping[str, str], longest: float) -> Any:
    """The JSON that the module prints on a line behind a mark; raises `NoAnswer`. longest: time limit [s]."""
    roots = os.pathsep.join(p for p in [*sys.path, str(Path(__file__).parents[3])] if p)
    try:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, env={**os.environ, "PYTHONPATH": roots, **environment}, start_new_session=True,
        )  # fmt: skip
    except OSError as error:
        raise NoAnswer(f"{error.strerror}", started=False) from None
    with process:
        try:
            output, _ = process.communicate(timeout=longest)
        except subprocess.TimeoutExpired:
            raise NoAnswer(f"more than {longest:g} s", overdue=True) from None
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # with what it started
    lines = [line for line in output.decode(errors="replace").splitlines() if line.startswith(mark)]
    if not lines:
        code = process.returncode
        raise NoAnswer(f"ended the process with {f'signal {-code}' if code < 0 else f'exit code {code}'}")
    return json.loads(lines[-1].removeprefix(mark))
