"""Runs a command in a child process, so that code which ends the process cannot leave an exit code of its own.

Simulators, components and packages may run in the process of a command, and a library in C or Fortran may end it with
any code, 0 included. The child reports its code at its end; without that there is no result. Start at `witnessed`.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

from worker.running.processes.lifeline import die_with_parent

FORWARDED = {signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2}
_BY_KERNEL = 0x80
"""The origin of a signal that a terminal sent to the whole group, the child included: SI_KERNEL, sigaction(2)."""

ENDED = (
    "Error: the process of this command ended with exit code {code} and without a result: code that runs in it ended "
    "it, such as a simulator with isolated=False, or of a package. Let it raise an exception in place of ending the "
    "process, or isolate the simulator."
)


class Witness:
    """The child's end of the pipe by which it reports its exit code."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def report(self, code: int) -> None:
        """State the exit code with which this process is about to end."""
        os.write(self._descriptor, bytes([code]))


def witnessed(lost: int) -> Witness | None:
    """Returns in the child; the parent waits and ends as the child does, but with the code `lost` and a sentence on
    standard error if the child ends with a code that it did not report. None on other systems than Linux."""
    if sys.platform != "linux":
        return None
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    reader, writer = os.pipe()
    parent, before = os.getpid(), signal.pthread_sigmask(signal.SIG_BLOCK, {*FORWARDED, signal.SIGCHLD})
    child = os.fork()
    if child == 0:
        die_with_parent(parent, signal.SIGKILL)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(reader)
        return Witness(writer)
    os.close(writer)
    status = _waited(child)
    os.set_blocking(reader, False)  # what the child started may still have the other end
    _end(status, _reported(reader), lost)
    return None


def _waited(child: int) -> int:
    """The exit code of the child, negative for a signal; until then it gets the signals that this process gets."""
    while True:
        signalled = signal.sigwaitinfo({*FORWARDED, signal.SIGCHLD})
        if signalled.si_signo != signal.SIGCHLD:
            if signalled.si_code != _BY_KERNEL:
                os.kill(child, signalled.si_signo)
            continue
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)


def _reported(reader: int) -> int | None:
    try:
        return next(iter(os.read(reader, 1)), None)
    except BlockingIOError:
        return None


def _end(status: int, reported: int | None, lost: int) -> None:
    if status < 0:
        if -status != signal.SIGKILL:
            signal.signal(-status, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {-status})
        os.kill(os.getpid(), -status)
    if status == reported:
        os._exit(status)
    with suppress(OSError):  # without a reader
        os.write(2, f"{ENDED.format(code=status)}\n".encode())
    os._exit(lost)
