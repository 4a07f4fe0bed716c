"""The process of live simulations, as tests talk to it."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from typing import Any

import pytest

PATIENCE = 60.0


class Live:
    """One process that answers."""

    def __init__(self, **environment: str) -> None:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        command = [sys.executable, "-m", "worker.running.processes.live"]
        self.process = subprocess.Popen(command, env={**os.environ, **environment}, **pipes)
        assert self.process.stdout is not None
        self.buffer = b""

    def say(self, line: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + b"\n")
        self.process.stdin.flush()

    def hear(self) -> Any:
        """The next line, which must be JSON as the standard has it."""
        assert self.process.stdout is not None
        while b"\n" not in self.buffer:
            assert select.select([self.process.stdout], [], [], PATIENCE)[0], "no answer"
            more = os.read(self.process.stdout.fileno(), 1 << 16)
            assert more, "the process ended"
            self.buffer += more
        line, _, self.buffer = self.buffer.partition(b"\n")
        return json.loads(line, parse_constant=lambda name: pytest.fail(f"{name} in an answer"))

    def ask(self, **request: Any) -> Any:
        self.say(json.dumps(request).encode())
        return self.hear()

    def end(self) -> tuple[int, bytes]:
        """Close its input; exit code and what it wrote to standard error."""
        _, errors = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, errors
