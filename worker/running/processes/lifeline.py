"""Starts child processes that cannot outlive their parent, even if it is killed with SIGKILL, and waits for events.

Source: prctl(2), PR_SET_PDEATHSIG (Linux). The signal is sent when the *thread* that started the process ends, so
children must be started from the main thread.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import signal
import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from types import FrameType
from typing import Any, Self

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None) if sys.platform == "linux" else None


def start(command: Sequence[str], *, when_orphaned: signal.Signals, **options: Any) -> subprocess.Popen[bytes]:
    """Start a process as the leader of its own group; it gets the signal `when_orphaned` when this process ends.

    `options` are those of `subprocess.Popen`. The signal is sent only on Linux.
    """
    orphaned = partial(die_with_parent, os.getpid(), when_orphaned)
    return subprocess.Popen(command, process_group=0, preexec_fn=orphaned, **options)


def die_with_parent(parent: int, when_orphaned: signal.Signals) -> None:
    """Send this process, which has just begun, the signal when its parent, the process of this number, ends."""
    if _LIBC is not None:
        _LIBC.prctl(_PR_SET_PDEATHSIG, int(when_orphaned))
        if os.getppid() != parent:  # the parent ended before the call
            os._exit(1)


class Wakeup:
    """A context that handles SIGTERM, SIGINT and SIGHUP: it stores the first one, and every signal ends a wait."""

    def __init__(self) -> None:
        self.signal: int | None = None
        """The first of these signals received."""

    def __enter__(self) -> Self:
        self._reader, self._writer = os.pipe()
        os.set_blocking(self._reader, False)
        os.set_blocking(self._writer, False)
        self._wakeup_before = signal.set_wakeup_fd(self._writer, warn_on_full_buffer=False)
        handlers = dict.fromkeys((signal.SIGTERM, signal.SIGINT, signal.SIGHUP), self._stop)
        # SIGCHLD needs a handler, even an empty one, to end a wait when a child ends.
        self._before = {n: signal.signal(n, h) for n, h in {**handlers, signal.SIGCHLD: lambda *_: None}.items()}
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._wakeup_before)
        os.close(self._reader)
        os.close(self._writer)

    def _stop(self, number: int, _frame: FrameType | None) -> None:
        self.signal = self.signal or number

    def wait(self, seconds: float, *others: int) -> bool:
        """Wait for one of the file descriptors, a signal or the timeout [s]; true if one of `others` is readable."""
        ready, _, _ = select.select([self._reader, *others], [], [], max(0.0, seconds))
        if self._reader in ready:
            os.read(self._reader, 4096)
        return any(other in ready for other in others)


def kill_group(process: subprocess.Popen[bytes]) -> int:
    """Kill the process and its group with SIGKILL; returns its exit status as in `Popen.returncode`."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    return process.wait()


def how_it_ended(status: int) -> str:
    """An exit status as text that completes "the process ...": `ended with signal 9 (SIGKILL)`."""
    if status >= 0:
        return f"ended with exit code {status}"
    try:
        return f"ended with signal {-status} ({signal.Signals(-status).name})"
    except ValueError:
        return f"ended with signal {-status}"
