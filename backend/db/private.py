"""Makes the files of the service and its workers unreadable for other users of the machine, by POSIX modes."""

from __future__ import annotations

import logging
import os
import stat
from collections.abc import Iterator
from pathlib import Path

import sqlalchemy as sa

from campaigns.refusals import Refusal

UMASK = 0o077
FOLDER = 0o700
FILE = 0o600

OWN = ("clearance.sqlite3*", "serve.lock", "backend.lock", "login-link", "service-address")
"""The service's own files in its data folder; other files there are not touched."""

_log = logging.getLogger(__name__)


class SharedFolderError(Refusal, ValueError):
    """The data folder is shared by all users of the machine, such as /tmp."""


def keep_private(data: Path, database: str = "") -> None:
    """Create the data folder, make it and its files private, and set the umask for files created later.

    data: created if missing. database: a URL; an SQLite file may be outside the data folder. Raises
    `SharedFolderError` and `OSError`. A mode that cannot be changed because another user owns the file is logged.
    """
    os.umask(UMASK)
    data.mkdir(mode=FOLDER, parents=True, exist_ok=True)
    if data.stat().st_mode & stat.S_ISVTX:
        raise SharedFolderError(
            f"the data folder {data} is shared by all users of this machine: choose a private folder"
        )
    for path in [data.resolve(), *_files(data, database)]:
        _tighten(path)


def create_private(file: Path) -> None:
    """Create an empty file that only its owner may read, unless it exists."""
    file.parent.mkdir(mode=FOLDER, parents=True, exist_ok=True)
    try:
        os.close(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, FILE))
    except FileExistsError:
        return


def write_private(path: Path, text: str) -> None:
    """Write a private file atomically."""
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    with open(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, FILE), "w", encoding="utf-8") as file:
        file.write(text)
    draft.replace(path)


def _files(data: Path, database: str) -> Iterator[Path]:
    for pattern in OWN:
        yield from data.glob(pattern)
    logs = data / "logs"
    if logs.is_dir():
        yield logs
        yield from logs.glob("*.log")
    named = sa.make_url(database).database if database.startswith("sqlite") else None
    if named:
        yield from (Path(named + suffix) for suffix in ("", "-wal", "-shm"))


def _tighten(path: Path) -> None:
    """Remove all permissions of other users. Symbolic links are skipped: their target may belong to another user."""
    if path.is_symlink() or not path.exists():
        return
    mode = stat.S_IMODE(path.stat().st_mode)
    if not mode & UMASK:
        return
    try:
        path.chmod(mode & ~UMASK)
    except PermissionError:
        _log.warning("%s is readable by other users and is owned by another user: change its owner or its mode", path)
