"""The services that run for this user on this machine, so that a command finds them from any folder.

Every service has a file in `folder()`, which it locks for as long as it runs: a file without a lock is left over from a
service that was killed.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from backend.db.engine import default_url
from backend.db.private import FOLDER, create_private


@dataclass(frozen=True)
class Running:
    """A running service: its data folder, its address, and whether its database is the usual file in that folder.

    The URL of another database is not stored, because it may contain a password.
    """

    data: str
    address: str
    usual: bool


def folder() -> Path:
    """The folder of the registered services of this user: XDG_STATE_HOME, else ~/.local/state, clearance/services."""
    base = os.environ.get("XDG_STATE_HOME")
    return (Path(base) if base else Path.home() / ".local" / "state") / "clearance" / "services"


@contextmanager
def registered(data: Path, database: str, address: str) -> Iterator[None]:
    """Registers a service within the block; one that cannot be registered runs all the same."""
    service = Running(str(data.absolute()), address, database == default_url(data))
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError, RuntimeError):  # RuntimeError: this user has no home
            _entered(service, stack)
        yield


def _entered(service: Running, stack: contextlib.ExitStack) -> None:
    """Write and lock the file of this process before others can see it; `stack` deletes it."""
    file = folder() / f"{os.getpid()}.json"
    draft = file.with_suffix(".draft")
    file.parent.mkdir(mode=FOLDER, parents=True, exist_ok=True)
    draft.unlink(missing_ok=True)
    create_private(draft)
    entry = stack.enter_context(draft.open("w", encoding="utf-8"))
    fcntl.flock(entry, fcntl.LOCK_EX | fcntl.LOCK_NB)
    json.dump(asdict(service), entry)
    entry.flush()
    draft.replace(file)
    stack.callback(file.unlink, missing_ok=True)


def services() -> list[Running]:
    """The services that run now; what is left over from others is deleted."""
    found = []
    with contextlib.suppress(OSError, RuntimeError):
        for file in sorted(folder().glob("*.json")):
            with contextlib.suppress(OSError, ValueError, TypeError), file.open(encoding="utf-8") as entry:
                if _locked(entry.fileno()):
                    found.append(Running(**json.load(entry)))
                else:
                    file.unlink(missing_ok=True)
    return found


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    return False
