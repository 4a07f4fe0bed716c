"""Starts processes that cannot outlive the one that started them, even when it is killed with SIGKILL.

Source: prctl(2), PR_SET_PDEATHSIG (Linux). The signal is sent when the *thread* that started the process ends, so start
them from the main thread. Start reading at `start`.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None) if sys.platform == "linux" else None


def start(command: Sequence[str], *, when_orphaned: signal.Signals, **options: Any) -> subprocess.Popen[bytes]:
    """Start a process at the head of its own group; it gets the signal `when_orphaned` once this one is gone.

    `options` are those of `subprocess.Popen`. Elsewhere than on Linux nothing is sent.
    """
    parent = os.getpid()

    def die_with_parent() -> None:
        if _LIBC is not None:
            _LIBC.prctl(_PR_SET_PDEATHSIG, int(when_orphaned))
            if os.getppid() != parent:  # it ended before it could be watched
                os._exit(1)

    return subprocess.Popen(command, process_group=0, preexec_fn=die_with_parent, **options)


def kill_group(process: subprocess.Popen[bytes]) -> int:
    """End the process and all that it started with SIGKILL; returns its exit status as `Popen.returncode` has it."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    return process.wait()


def how_it_ended(status: int) -> str:
    """An exit status in words, for "the process ...": `ended with signal 9 (SIGKILL)`."""
    if status >= 0:
        return f"ended with exit code {status}"
    try:
        return f"ended with signal {-status} ({signal.Signals(-status).name})"
    except ValueError:
        return f"ended with signal {-status}"
