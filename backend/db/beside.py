"""The files beside an SQLite file, -wal and -shm: whether they were deleted while this process uses them.

SQLite goes on writing into deleted files, and what others open meanwhile has other ones: what both write destroys the
database. As long as a connection is open, SQLite itself neither deletes nor replaces them. Source: sqlite.org,
howtocorrupt.html, 2.3. Closing the last connection brings into the database what the deleted file has.
"""

from __future__ import annotations

import os
import threading
import weakref
from pathlib import Path
from typing import Any

from backend.db.outages import DatabaseOutage

ENDINGS = ("-wal", "-shm")
SENTENCE = (
    "files of the database were deleted under the service (those that end with -wal and -shm): nothing more is "
    "written; an administrator must stop the service and all workers before starting them again, and run "
    "`clearance doctor`"
)

Inode = tuple[int, int] | None

_open: weakref.WeakSet[Any] = weakref.WeakSet()
"""The pool entries of this process whose connections are open; no other code closes them unnoticed."""
_guard = threading.Lock()
"""Other threads open connections meanwhile."""
_lost: dict[Path, Inode] = {}
"""The databases that this process opens no more: others may still use the deleted files."""


def inode(file: Path | str) -> Inode:
    """Which file has that name now; None if there is none."""
    try:
        found = os.stat(file)
    except OSError:
        return None
    return found.st_dev, found.st_ino


def opened(entry: Any, file: Path) -> None:
    """Note which files a new connection uses; it must have read from the database."""
    with _guard:
        entry.info["files"] = inode(file), _beside(file)
        _open.add(entry)


def closing(_connection: Any, entry: Any) -> None:
    """Forget a connection before it is closed: what SQLite itself deletes with the last one is no loss."""
    with _guard:
        _open.discard(entry)


def refuse_deleted(file: Path) -> None:
    """Raise `DatabaseOutage` if a connection of this process to this file used deleted files beside it."""
    now = inode(file)
    if now is None or (_lost.get(file) != now and not _uses_deleted(file, now)):
        return
    _lost[file] = now
    error = FileNotFoundError(f"{file} has other files {' and '.join(ENDINGS)} than this process has used")
    raise DatabaseOutage("database-gone", SENTENCE, error, False)


def _uses_deleted(file: Path, now: Inode) -> bool:
    with _guard:
        used = [(entry, entry.info["files"]) for entry in _open]  # before looking: later ones have others by right
    beside = _beside(file)
    suspects = [(entry, files) for entry, files in used if files[0] == now and files[1] != beside]
    with _guard:  # one that closed meanwhile may have been the last
        return any(entry in _open and entry.info.get("files") is files for entry, files in suspects)


def _beside(file: Path) -> tuple[Inode, ...]:
    return tuple(inode(f"{file}{ending}") for ending in ENDINGS)
