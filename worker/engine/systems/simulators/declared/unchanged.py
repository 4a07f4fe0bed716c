"""Whether the files of a simulator are still those whose digest a run states."""

from __future__ import annotations

import hashlib
import os
import threading
import time
from collections.abc import Sequence
from pathlib import Path

PAUSE = 0.5
"""Time between two looks at the files [s], and at least so many times what a look takes: `LEISURE`."""
LEISURE = 50.0

Mark = tuple[int, int, int, int]
"""What shows without reading a file that it may have changed: times of its content and of its entry, size, inode."""


class Unchanged:
    """These files as they are when this is made, which is before their digest is read: what changes in between is a
    change, too. Files that appear later are no part of it. Safe for threads."""

    def __init__(self, files: Sequence[Path]) -> None:
        self._files = {path: (mark(path), _content(path)) for path in files}
        self._lock = threading.Lock()
        self._next = time.monotonic() + PAUSE
        self._changed = ""

    def changed(self, now: bool = False) -> str:
        """A sentence that names the first file that has changed or is gone; empty if there is none.

        The files are looked at now, or else now and then. A file that has changed once stays so.
        """
        if now or time.monotonic() >= self._next:
            with self._lock:
                began = time.monotonic()
                if (now or began >= self._next) and not self._changed:
                    self._changed = self._looked()
                    took = time.monotonic() - began
                    self._next = time.monotonic() + max(PAUSE, LEISURE * took)
        return self._changed

    def _looked(self) -> str:
        for path, (before, content) in self._files.items():
            now = mark(path)
            if now == before:
                continue
            if _content(path) != content:
                return f"{path.name} has changed since this run opened it; start the run again"
            self._files[path] = (now, content)
        return ""


def mark(path: str | Path) -> Mark | None:
    """The mark of a file as it is now; None if it is gone."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ctime_ns, found.st_size, found.st_ino


def _content(path: Path) -> str | None:
    """The digest of a file; None if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None
