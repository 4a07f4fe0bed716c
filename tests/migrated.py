"""Databases of the newest form, copied from one that was migrated once in a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import sqlalchemy as sa

from backend.db.engine import default_url, migrate


@cache
def empty() -> bytes:
    """To migrate takes a fifth of a second of processor time, and more in a process that has not done it yet."""
    with TemporaryDirectory() as folder:
        migrate(default_url(Path(folder)))
        return _file(Path(folder)).read_bytes()


def migrated(data: Path) -> str:
    """Make an empty database in that folder, unless it has one, which others may have opened; its URL."""
    data.mkdir(parents=True, exist_ok=True)
    if not _file(data).exists():
        _file(data).write_bytes(empty())
    return default_url(data)


def _file(data: Path) -> Path:
    return Path(sa.make_url(default_url(data)).database or "")
