"""What a node is sent and returns, and whether it would compute what this process would.

It imports nothing heavy: the scheduler loads it too.
"""

from __future__ import annotations

import contextlib
import socket
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from worker.engine.systems.simulators.declared.below import files_below
from worker.engine.systems.simulators.declared.folder import digest_of, digest_of_place, files_of_place
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.program import Program

WORK = "{work}"
"""Stands for the node's own temporary folder in the folder of a program."""
ROOT = Path(__file__).parents[5]
"""The folder of the installation."""


class NodeUnusable(Exception):
    """A node would not compute what this process would; the message names it and the difference."""


class NodeClosing(Exception):
    """The node is shutting down, or the pool was closed: what it evaluated has no result."""


@dataclass(frozen=True)
class Files:
    """The files of a simulator, which every node must have: all those of its folder, or those of a function's place.

    place: of a Python function, its `name` and its `file` or `module`; empty for a simulator with a descriptor.
    """

    folder: str
    digest: str
    place: Mapping[str, str] = field(default_factory=dict)

    def found(self) -> str:
        """The digest of these files on this machine; raises OSError."""
        return digest_of_place(self.place) if self.place else digest_of(Path(self.folder))

    def covered(self) -> list[Path]:
        """The files on this machine that the digest covers; raises OSError."""
        return files_of_place(self.place) if self.place else files_below(Path(self.folder))


@dataclass(frozen=True)
class Work:
    """What a node needs to evaluate a simulator: the program, its limits, and what must be the same there.

    key: identifies the slots that belong together; python, root: interpreter and installation where the program was
    written down; code: the digest of the code that runs slots.
    """

    key: str
    program: Program
    limits: Limits
    files: Files
    python: str = sys.executable
    root: str = str(ROOT)
    code: str = ""


@dataclass(frozen=True)
class Done:
    """The outcomes of the first evaluations of a batch, and how long the task took [s]."""

    outcomes: list[Outcome]
    seconds: float


@cache
def code() -> str:
    """The digest of the code that runs slots."""
    return digest_of(Path(__file__).parents[1])


_checked: dict[str, Unchanged] = {}
"""The files of each work as they were when they were compared."""


def check(work: Work) -> None:
    """Compare code and files with those of the process that asks, once, then see whether the files have changed since;
    raises `NodeUnusable`."""
    if work.code != code():
        raise NodeUnusable(
            f"{name()} has another version of Clearance in {ROOT}: install the same one on all nodes, and restart "
            "their Dask workers"
        )
    if work.key not in _checked:
        _checked[work.key] = _compared(work.files)
    elif different := changed(work.key):
        raise NodeUnusable(different)


def changed(key: str, now: bool = False) -> str:
    """Why this node no longer evaluates work, a sentence; empty if its files are as they were, or it has none of it."""
    files = _checked.get(key)
    found = "" if files is None else files.changed(now)
    return found and f"{name()}: {found}"


def forget(key: str) -> None:
    """The work of that key has ended."""
    _checked.pop(key, None)


def _compared(files: Files) -> Unchanged:
    """The files here, which are those stated; raises `NodeUnusable`."""
    folder, module = Path(files.folder), files.place.get("module")
    if module is None and not folder.is_dir():
        raise NodeUnusable(
            f"{name()} has no folder {folder}: put the simulator's folder under the same path on all nodes"
        )
    what = f"the package of {module}" if module else f"the simulator's folder {folder}"
    try:
        here = Unchanged(files.covered())
        digest = files.found()
    except OSError as error:
        raise NodeUnusable(f"{name()} cannot read {what}: {error.strerror}") from None
    if digest == files.digest:
        return here
    other = f"(digest {digest[:12]}, expected {files.digest[:12]})"
    if module:
        what = f"{name()} has other files for {module} {other}: install the same version of the package on all nodes"
        raise NodeUnusable(what)
    raise NodeUnusable(f"{name()} has other files in {folder} {other}: copy the simulator's folder to all nodes")


def name() -> str:
    """The node in a sentence."""
    from distributed import get_worker

    address = ""
    with contextlib.suppress(ValueError):  # outside a task
        address = f" ({get_worker().address})"
    return f"node {socket.gethostname()}{address}"
