"""Locks a data folder and an SQLite file: two services on one would revoke each other's login links, and each would
count its limits by itself."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Literal, TextIO

import sqlalchemy as sa

from campaigns.refusals import Refusal

Lock = Literal["serve.lock", "backend.lock"]
"""Of `clearance serve`, and of the service itself, which the former starts."""


class InUseError(Refusal, ValueError):
    """The folder is locked by another process, or cannot be locked: a sentence."""


@contextmanager
def alone(data: Path | None, url: str, lock: Lock) -> Iterator[None]:
    """Holds the locks within the block; a process that dies releases them. Raises `InUseError`.

    data: None if there is no folder yet. url: of the database; services with other data folders find the lock next to
    an SQLite file. Where that cannot be made, the file cannot be used, either.
    """
    with ExitStack() as locks:
        if data is not None:
            try:
                file = locks.enter_context((data / lock).open("a+"))
            except OSError as error:
                raise InUseError(f"the folder {data} cannot be written: {error.strerror}") from None
            _locked(file, lock, data, "--data")
        name = sa.make_url(url).database if url.startswith("sqlite") else None
        if name and name != ":memory:" and not name.startswith("file:"):
            database = Path(name).resolve()
            with suppress(OSError):
                database.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
                beside = locks.enter_context(database.with_name(f"{database.name}.{lock}").open("a+"))
                _locked(beside, lock, database, "--database")
        yield


def _locked(file: TextIO, lock: Lock, what: Path, option: str) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.seek(0)
        owner = file.read().strip() or "another process"
        by = "`clearance serve`" if lock == "serve.lock" else "a service"
        raise InUseError(f"{what} is in use by {by} ({owner}); stop it or name another {option}") from None
    file.truncate(0)
    file.write(f"process {os.getpid()}")
    file.flush()
