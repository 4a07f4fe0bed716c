"""The supervisor's side of its child process: one line of JSON in each direction, with a deadline."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from typing import TypedDict

from worker.engine.systems.simulators.slots import places
from worker.engine.systems.simulators.slots.guard import END
from worker.engine.systems.simulators.slots.slot import guarded
from worker.running.processes import lifeline
from worker.running.processes.lifeline import Wakeup
from worker.running.runs.pulse import Pulse

PATIENCE = 4.0
"""Time for it to end with all that it started [s]: longer than the slots have."""


class Message(TypedDict, total=False):
    """What a child sends: when it has started, its code, simulators and installation; then how each claim ended."""

    fresh: bool
    simulators: list[str]
    installation: str
    outcome: str
    text: str


class ChildEndedError(RuntimeError):
    """The child has ended; the message states how and completes "the worker process ...".

    killed: by a signal that only others send.
    """

    def __init__(self, status: int) -> None:
        super().__init__(lifeline.how_it_ended(status))
        self.killed = -status in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


class Child:
    """A running `worker.running.processes.child` in its own process group; it is killed when this process ends, and
    with it whatever it started."""

    def __init__(self, setup: Mapping[str, object], wakeup: Wakeup) -> None:
        self.pulse, file = Pulse.shared()
        command = [sys.executable, "-P", "-m", "worker.running.processes.child", str(file)]
        self.ready = False
        """Whether it has reported that it is ready."""
        self.begun = time.monotonic()
        controlled, self._control = os.pipe()
        begun = guarded(controlled, grace=PATIENCE, died=PATIENCE)
        self._process = subprocess.Popen(
            [*begun, *command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0,
            pass_fds=(controlled, file), start_new_session=True,
        )  # fmt: skip
        os.close(controlled)
        os.close(file)
        self._wakeup, self._received = wakeup, b""
        self.send(setup)

    def alive(self) -> bool:
        """Whether it is still running."""
        return self._process.poll() is None

    def send(self, message: Mapping[str, object]) -> None:
        """Send one message; raises `ChildEndedError`."""
        assert self._process.stdin is not None
        data = memoryview(json.dumps(message).encode() + b"\n")
        try:
            while data:
                data = data[self._process.stdin.write(data) :]
        except BrokenPipeError:
            raise self._ended() from None

    def receive(self, seconds: float) -> Message | None:
        """The next message; None after the timeout [s] or a signal. Raises `ChildEndedError`."""
        assert self._process.stdout is not None
        deadline = time.monotonic() + seconds
        while b"\n" not in self._received:
            if not self._wakeup.wait(deadline - time.monotonic(), self._process.stdout.fileno()):
                return None
            data = os.read(self._process.stdout.fileno(), 65536)
            if not data:
                raise self._ended()
            self._received += data
        line, _, self._received = self._received.partition(b"\n")
        message: Message = json.loads(line)
        return message

    def kill(self) -> None:
        """Kill it; what it evaluated in slots is asked to end first. The folders that it had not yet removed go."""
        if self._control < 0:
            return
        with contextlib.suppress(BrokenPipeError):
            os.write(self._control, END)
        self._process.wait()
        places.remove_left()
        os.close(self._control)
        self._control = -1
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()

    def _ended(self) -> ChildEndedError:
        """The error for a child that has closed its pipe: it is about to end, or is killed after 5 s."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=5.0)
        self.kill()
        return ChildEndedError(self._process.returncode)
