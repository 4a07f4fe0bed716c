"""Finds what a process of ours has started by a mark in its environment, and ends it.

Guards end what runs in slots. This is for what is left when a guard was killed.
"""

from __future__ import annotations

import contextlib
import os
import signal
import time

MARK = "CLEARANCE_SLOT"
WAIT = 4.0
"""Time for guards to end what runs below them [s]."""


def mark(name: str) -> str:
    """A mark of this process: its number and when it started, since numbers are used again."""
    return f"{os.getpid()}.{_started(os.getpid())}-{name}"


def end(prefix: str, wait: float = 0.0) -> None:
    """Kill what carries a mark that begins so, if it has not ended within this time [s]."""
    until = time.monotonic() + wait
    while carrying(prefix) and time.monotonic() < until:
        time.sleep(0.01)
    killed: set[int] = set()
    while found := {*carrying(prefix)} - killed:  # again, as it may have started more meanwhile
        killed |= found
        for process in found:
            with contextlib.suppress(OSError):
                os.kill(process, signal.SIGKILL)


def end_orphans() -> None:
    """End what was started by processes that are no more."""
    owners = {value.partition("-")[0] for value in _marks().values()}
    for owner in owners:
        number, _, started = owner.partition(".")
        if number.isdigit() and _started(int(number)) != started:
            end(f"{owner}-", WAIT)


def carrying(prefix: str) -> list[int]:
    """The processes whose mark begins so, without this one."""
    return [process for process, value in _marks().items() if value.startswith(prefix) and process != os.getpid()]


def _marks() -> dict[int, str]:
    sought = f"{MARK}=".encode()
    found: dict[int, str] = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/environ", "rb", buffering=0) as file:
                environment = file.readall()
        except OSError:
            continue
        if sought in environment:
            values = [part for part in environment.split(b"\0") if part.startswith(sought)]
            found |= {int(entry): part.removeprefix(sought).decode(errors="replace") for part in values[-1:]}
    return found


def _started(process: int) -> str:
    """When a process started, in the kernel's units; empty if there is none."""
    try:
        with open(f"/proc/{process}/stat", "rb", buffering=0) as file:
            return file.read(4096).rpartition(b")")[2].split()[19].decode()
    except OSError:
        return ""
