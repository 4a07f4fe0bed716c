"""The processes behind `clearance serve`: started together, monitored, restarted when they die, stopped together.

Their output goes to log files in the data folder.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from worker.running.processes import lifeline
from worker.running.processes.lifeline import Wakeup

STOP = 5.0
"""Time for the processes to end after SIGTERM before they are killed [s]."""

LONGEST_PAUSE = 30.0
"""The longest delay before a process that keeps dying is restarted [s]."""

STEADY = 60.0
"""A process that ran at least this long before it died is restarted without delay [s]."""

LARGEST_LOG = 10_000_000
"""A log larger than this is replaced by a new one; the previous log is renamed to .old.log [bytes]."""


WARNING = "WARNING clearance: "
"""How a line of the service's log begins that concerns who started it."""


@dataclass
class Server:
    """One process to run: what it is called at the beginning of a sentence, its command and log."""

    title: str
    command: Sequence[str]
    environment: Mapping[str, str]
    log: Path
    when_orphaned: signal.Signals
    process: subprocess.Popen[bytes] | None = None
    started: float = 0.0
    pause: float = 0.0
    due: float = 0.0
    status: int | None = None
    """Exit status of its last end, as in `Popen.returncode`."""
    final: int | None = None
    """The exit status after which it is not started again."""
    begins: int = 0
    """Where the log of this start begins [bytes]."""

    def start(self) -> None:
        """Start it; its output is appended to its log."""
        self.log.parent.mkdir(parents=True, exist_ok=True)
        if self.log.exists() and self.log.stat().st_size > LARGEST_LOG:
            self.log.replace(self.log.with_suffix(".old.log"))
        with self.log.open("ab") as output:
            self.begins = output.tell()
            self.process = lifeline.start(
                self.command,
                when_orphaned=self.when_orphaned,
                env={**os.environ, **self.environment},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        self.started = time.monotonic()

    def warnings(self) -> list[str]:
        """What it has warned of since this start, such as a misspelled setting."""
        try:
            lines = self.log.read_bytes()[self.begins :].decode(errors="replace").splitlines()
        except OSError:
            return []
        return [text for line in lines if (text := _warning(line))]

    def tail(self) -> str:
        """The last lines of its log."""
        try:
            text = self.log.read_text(errors="replace")[-4000:]
        except OSError:
            return ""
        return "\n".join("    " + line for line in text.splitlines()[-8:])


def _warning(line: str) -> str:
    """The sentence of a line that concerns who started it, in either form of the log; empty for other lines."""
    if not line.startswith("{"):
        return line.removeprefix(WARNING) if line.startswith(WARNING) else ""
    try:
        found = json.loads(line)
    except ValueError:
        return ""
    mine = (found.get("level"), found.get("logger")) == ("WARNING", "clearance")
    return str(found.get("message", "")) if mine else ""


class Servers:
    """All the processes; `report` is called with a sentence about every event."""

    def __init__(self, servers: Sequence[Server], wakeup: Wakeup, report: Callable[[str], None]) -> None:
        self.servers, self.report, self._wakeup = list(servers), report, wakeup

    def start(self) -> None:
        for server in self.servers:
            server.start()

    def watch(self, seconds: float) -> list[Server]:
        """Monitor them for about this long [s]; returns those that died, which are restarted after a delay."""
        self._wakeup.wait(seconds)
        return [server for server in list(self.servers) if self._died(server)]

    def stop(self) -> None:
        """Terminate them with SIGTERM and, after a timeout, with SIGKILL."""
        running = [server.process for server in self.servers if server.process is not None]
        for process in running:
            process.send_signal(signal.SIGTERM)
        deadline = time.monotonic() + STOP
        while any(process.poll() is None for process in running) and time.monotonic() < deadline:
            self._wakeup.wait(0.05)
        for process in running:
            lifeline.kill_group(process)

    def _died(self, server: Server) -> bool:
        at = time.monotonic()
        if server.process is None:
            if at >= server.due:
                server.start()
            return False
        status = server.process.poll()
        if status is None:
            return False
        lifeline.kill_group(server.process)
        server.process, server.status = None, status
        if status == server.final:
            self.report(f"{server.title} has ended as it was asked to; it is not started again.")
            self.servers = [one for one in self.servers if one is not server]
            return False
        server.pause = 0.0 if at - server.started > STEADY else min(LONGEST_PAUSE, max(0.5, 2 * server.pause))
        server.due = at + server.pause
        how = lifeline.how_it_ended(status)
        self.report(f"{server.title} {how}; restarting it in {server.pause:g} s. From {server.log}:")
        self.report(server.tail())
        return True
