"""Free space where the data is: below a limit no new run begins, so that those that run can still be stored."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import sqlalchemy as sa

from backend.db import outages

VARIABLE = "CLEARANCE_MIN_FREE"
MIN_FREE = 500_000_000
"""The limit unless the variable states another [bytes]."""
TRIED = 100_000
"""What is written to find out whether the disk is still full [bytes]."""


def places(url: str, data: Path | None) -> tuple[Path, ...]:
    """The folders in which the service and its workers write: that of an SQLite file, and the data folder."""
    file = sa.make_url(url).database if url.startswith("sqlite") else None
    return (*([] if file is None else [Path(file).absolute().parent]), *([] if data is None else [data.absolute()]))


@dataclass(frozen=True)
class Room:
    """Where the service writes, and how much must stay free there [bytes]."""

    folders: tuple[Path, ...]
    limit: int

    def free(self) -> int | None:
        """The least free space of the folders [bytes]; None if none of them is there."""
        found = []
        for folder in self.folders:
            try:
                found.append(shutil.disk_usage(folder).free)
            except OSError:  # reported by what needs the folder
                continue
        return min(found, default=None)

    def short(self) -> str:
        """Why no new run may begin, a sentence; empty if there is enough space."""
        left = self.free()
        if left is None or left >= self.limit:
            return ""
        return (
            f"the disk of the database has {left / 1e6:,.0f} MB left, and new runs need {self.limit / 1e6:,.0f} MB "
            f"({VARIABLE}): an administrator must free space"
        )


def refuse_full(engine: sa.Engine) -> None:
    """Raises `DatabaseOutage` or `OSError` if a write failed for want of space, and one that is tried now does too.

    What is tried is rolled back. SQLite writes it to the disk only later, so that a file next to it is tried as well.
    """
    if not outages.met(engine, "no-space"):
        return
    for folder in places(str(engine.url), None):
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(TRIED))
            file.flush()
    with engine.connect() as connection, connection.begin() as tried:
        connection.exec_driver_sql("create table space_that_is_tried (content text)")
        connection.execute(
            sa.text("insert into space_that_is_tried (content) values (:content)"), {"content": "0" * TRIED}
        )
        tried.rollback()
    outages.over(engine, "no-space")


def limit_of(environment: Mapping[str, str]) -> int:
    """The limit that the environment states [bytes]; raises `ValueError` unless it is a whole number, 0 for none."""
    text = environment.get(VARIABLE, "") or str(MIN_FREE)
    if not (text.isascii() and text.isdigit()) or len(text) > 18:
        raise ValueError(f"{VARIABLE} is a whole number of bytes, such as {MIN_FREE}; given {text!r}")
    return int(text)
