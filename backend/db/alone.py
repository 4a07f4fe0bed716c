"""Locks a data folder: two services on one folder would revoke each other's login links."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from campaigns.refusals import Refusal

Lock = Literal["serve.lock", "backend.lock"]
"""Of `clearance serve`, and of the service itself, which the former starts."""


class InUseError(Refusal, ValueError):
    """The folder is locked by another process, or cannot be locked: a sentence."""


@contextmanager
def alone(data: Path, lock: Lock) -> Iterator[None]:
    """Holds the lock within the block; a process that dies releases it. Raises `InUseError`."""
    try:
        file = (data / lock).open("a+")
    except OSError as error:
        raise InUseError(f"the folder {data} cannot be written: {error.strerror}") from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.seek(0)
            owner = file.read().strip() or "another process"
            what = "`clearance serve`" if lock == "serve.lock" else "a service"
            raise InUseError(f"{data} is in use by {what} ({owner}); stop it or name another --data") from None
        file.truncate(0)
        file.write(f"process {os.getpid()}")
        file.flush()
        yield
