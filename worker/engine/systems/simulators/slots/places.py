"""Folders for temporary files of one process, which others can tell from those that a process left when it was killed.

Each is locked (flock(2)) while its owner lives, also in another container that shares the disk.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile
from pathlib import Path

from worker.engine.systems.simulators.slots.guard import PLACE


class Place:
    """A new folder, until it is closed or this process ends."""

    def __init__(self, name: str) -> None:
        made = Path(tempfile.mkdtemp(prefix=f"-{name}-"))
        self._lock = os.open(made, os.O_RDONLY)
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        self.path = made.rename(made.with_name(PLACE + made.name[1:]))  # from now on others find it, and locked

    def close(self) -> None:
        """Remove it with all that it contains."""
        shutil.rmtree(self.path, ignore_errors=True)
        lock, self._lock = self._lock, -1
        if lock >= 0:
            os.close(lock)


def remove_left() -> None:
    """Remove the folders of this user's processes that are no more."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PLACE}*"):
        with contextlib.suppress(OSError):
            if folder.lstat().st_uid != os.getuid():
                continue
            lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(lock)
