"""Real processes for the fault tests: started in their own session, monitored through /proc, always cleaned up."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

REPOSITORY = Path(__file__).parents[2]
CLEARANCE = [sys.executable, "-m", "clearance"]


class Started:
    """A running command; its output is written to a file."""

    def __init__(self, command: list[str], output: IO[bytes], **environment: str) -> None:
        self.output = Path(output.name)
        self.process = subprocess.Popen(
            command,
            cwd=REPOSITORY,
            env={**os.environ, "PYTHONPATH": str(REPOSITORY), "PYTHONUNBUFFERED": "1", **environment},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    @property
    def pid(self) -> int:
        return self.process.pid

    def text(self) -> str:
        """What it printed so far."""
        return self.output.read_text(errors="replace")

    def link(self) -> str:
        """The login link that it printed; empty before the whole line is there."""
        found = re.search(r"(http://\S+/login\?code=\S+)\n", self.text())
        return found[1] if found else ""

    def address(self) -> str:
        """Where the service of its login link is."""
        return self.link().partition("/login")[0]

    def family(self) -> list[int]:
        """A process and all that it started, directly or not, as long as they are alive."""
        return [pid for pid in [self.pid, *descendants(self.pid)] if alive(pid)]

    def child(self) -> int:
        """The process of a worker that does the work, below its guard (a fork of it has the same command line)."""
        guards = [pid for pid, parent in parents().items() if parent == self.pid and alive(pid)]
        below = [pid for pid, parent in parents().items() if parent in guards and alive(pid)]
        [child] = [pid for pid in below if "worker.running.processes.child" in command_of(pid)]
        return child


@contextmanager
def started(command: list[str], folder: Path, name: str = "output", **environment: str) -> Iterator[Started]:
    """The command while the block lasts; killed with all its family at the end."""
    with (folder / f"{name}.log").open("wb") as output:
        running = Started(command, output, **environment)
        try:
            yield running
        finally:
            kill(*running.family())
            running.process.wait()


@contextmanager
def worker(
    url: str, folder: Path, name: str, *options: str, within: Sequence[str] = (), **environment: str
) -> Iterator[Started]:
    """A worker on the database; on one core, so that its speed does not depend on their number.

    within: what its command begins with, as for another network namespace.
    """
    command = [*within, *CLEARANCE, "worker", "--name", name, *options]
    environment = {"CLEARANCE_DATABASE": url, "CLEARANCE_THREADS": "1", **environment}
    with started(command, folder, name, **environment) as running:
        yield running


def until(condition: Callable[[], object], what: str, seconds: float = 60.0) -> float:
    """Wait for the condition; returns how long it took [s], fails after `seconds`.

    It is asked again after 10 ms at first, and at last every 50 ms: asking takes processor time from what is awaited.
    """
    begun = time.monotonic()
    pause = 0.01
    while not condition():
        assert time.monotonic() - begun < seconds, f"{what}: not within {seconds:g} s"
        time.sleep(pause)
        pause = min(1.1 * pause, 0.05)
    return time.monotonic() - begun


def kill(*pids: int, number: signal.Signals = signal.SIGKILL) -> None:
    """Send each the signal, if it is still there."""
    assert all(pid > 0 for pid in pids), "0 is the group of this process"
    for pid in pids:
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            continue


def alive(pid: int) -> bool:
    """Whether the process exists and is no zombie."""
    fields = _stat(pid)
    return fields is not None and fields[0] != "Z"


def command_of(pid: int) -> str:
    """The command line of a process; empty once it is gone."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""


def parents() -> dict[int, int]:
    """The parent of every process there is."""
    found: dict[int, int] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and (fields := _stat(int(entry.name))) is not None:
            found[int(entry.name)] = int(fields[1])
    return found


def descendants(pid: int) -> list[int]:
    """All that a process started, directly or not."""
    tree = parents()
    found: list[int] = []
    front = [pid]
    while front:
        front = [child for child, parent in tree.items() if parent in front]
        found += front
    return found


def _stat(pid: int) -> list[str] | None:
    """State, parent, ... of a process, from /proc."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
