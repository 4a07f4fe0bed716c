"""What an installation needs, each with what is wrong and what to do, for `clearance doctor`; why no run can be done.

No check changes anything, and none fails by an exception: what cannot be found out is reported as that.
"""

from __future__ import annotations

import os
import platform
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Literal

import sqlalchemy as sa

from backend.db import damage, revision, space, workers
from backend.db.engine import connect, is_sqlite, now, read, refuse_read_only
from backend.db.outages import SENTENCES, DatabaseOutage
from backend.http.pages import unbuilt
from backend.reports.pdf import browser
from campaigns import Problem

State = Literal["ok", "warning", "failed"]

SHORT, TIGHT = 1e9, 5e9
"""Free space below which a check fails, and below which it warns [bytes]."""
APART = 5.0
"""Difference between the clocks of this machine and the database server that is reported [s]."""


@dataclass(frozen=True)
class Check:
    """One check: its name, how it ended, what was found, and what to do if anything."""

    name: str
    state: State
    found: str
    remedy: str = ""


def checks(data: Path, url: str, pages: Path, cache: Path) -> list[Check]:
    """All checks of an installation.

    data: its folder; url: of its database; pages: the folder of the built pages; cache: that of compiled kernels.
    """
    made: list[Callable[[], Iterator[Check]]] = [
        lambda: _folder(data),
        lambda: _database(url),
        lambda: _space(url, data, cache),
        lambda: _cache(cache),
        lambda: _programs(pages),
    ]
    return [check for one in made for check in _safely(one)]


def _safely(one: Callable[[], Iterator[Check]]) -> list[Check]:
    found: list[Check] = []
    try:
        found.extend(one())
    except Exception as error:
        found.append(Check("checks", "failed", f"a check ended by {type(error).__name__}: {error}", "report this"))
    return found


def _folder(data: Path) -> Iterator[Check]:
    if not data.is_dir():
        remedy = "name the folder of `clearance serve` with --data, or start the service, which makes it"
        yield Check("data folder", "failed", f"{data.absolute()} is no folder", remedy)
        return
    mode = stat.S_IMODE(data.stat().st_mode)
    if not os.access(data, os.W_OK):
        yield Check(
            "data folder", "failed", f"{data.absolute()} cannot be written", "give it to the user of the service"
        )
    elif mode & 0o077:
        remedy = f"chmod 700 {data.absolute()}; the service does so when it starts"
        yield Check("data folder", "warning", f"other users can read {data.absolute()} (mode {mode:o})", remedy)
    else:
        yield Check("data folder", "ok", f"{data.absolute()}, private and writable")


def _database(url: str) -> Iterator[Check]:
    file = sa.make_url(url).database if url.startswith("sqlite") else None
    if file is not None:
        if not Path(file).is_file():
            yield Check("database", "failed", f"there is no file {file}", "start the service, or restore a backup")
            return
        if wrong := damage.damage(Path(file)):
            remedy = "stop the service and workers, keep a copy of the file, and restore the newest backup"
            yield Check("database", "failed", f"{file} is damaged: {wrong}", remedy)
            return
    engine = connect(url, 5.0)
    try:
        with read(engine) as connection:
            yield Check("database", "ok", _described(connection, file))
            yield _schema(connection)
            if sa.inspect(connection).has_table("workers"):
                yield _workers(connection)
                yield _clock(connection)
    except sa.exc.DatabaseError as error:
        remedy = "start the server, and check address, user and password in CLEARANCE_DATABASE"
        yield Check("database", "failed", " ".join(f"{error.orig}".split()), remedy)
    finally:
        engine.dispose()


def _described(connection: sa.Connection, file: str | None) -> str:
    if file is not None:
        return f"{file}, {Path(file).stat().st_size / 1e6:.0f} MB, whole"
    return str(connection.scalar(sa.text("select version()"))).partition(" on ")[0]


def _schema(connection: sa.Connection) -> Check:
    stored, newest = revision.stored(connection), revision.newest()
    if stored == newest:
        return Check("schema", "ok", f"version {stored}, that of this version of Clearance")
    if stored is not None and stored > newest:
        return Check("schema", "failed", f"version {stored}; this version knows {newest}", "install the newer version")
    remedy = "start the service or a worker, which migrates it; make a backup before"
    return Check("schema", "warning", f"version {stored or 'none'}; the newest is {newest}", remedy)


def _workers(connection: sa.Connection) -> Check:
    live = workers.live(connection)
    if live:
        return Check("workers", "ok", f"{len(live)} alive: {', '.join(live[:5])}{' ...' if len(live) > 5 else ''}")
    return Check(
        "workers", "failed", "no worker is alive, so that runs wait", "start `clearance serve` or `clearance worker`"
    )


def _clock(connection: sa.Connection) -> Check:
    if is_sqlite(connection):
        newest = connection.scalar(sa.text("select max(beat) from workers")) or 0.0
        ahead = newest - time.time()
        found = f"a worker's newest heartbeat is {ahead:.0f} s in the future"
    else:
        ahead = abs(now(connection) - time.time())
        found = f"this machine and the database server differ by {ahead:.1f} s"
    if ahead > APART:
        return Check("clock", "warning", found, "synchronise the clocks (NTP); the queue uses that of the database")
    return Check("clock", "ok", "in step")


def _space(url: str, data: Path, cache: Path) -> Iterator[Check]:
    beside = [("the database", folder) for folder in space.places(url, None) if folder != data.absolute()]
    usual = [("data", data), ("temporary files", Path(tempfile.gettempdir())), ("compiled code", cache)]
    for what, folder in [*beside, *usual]:
        while not folder.exists():
            folder = folder.parent
        free = shutil.disk_usage(folder).free
        state: State = "failed" if free < SHORT else "warning" if free < TIGHT else "ok"
        remedy = "" if state == "ok" else "free space, `clearance purge` removed runs, or move the folder"
        yield Check(f"space for {what}", state, f"{free / 1e9:.1f} GB free at {folder.absolute()}", remedy)


def _cache(cache: Path) -> Iterator[Check]:
    files = [path for kind in ("nbi", "nbc") for path in cache.rglob(f"*.{kind}")] if cache.is_dir() else []
    damaged = sum(not _is_whole(path) for path in files)
    if damaged:
        remedy = f"none is needed: they are compiled again; to be rid of them delete {cache}"
        yield Check(
            "compiled code", "warning", f"{damaged} of {len(files)} files in {cache} are damaged or old", remedy
        )
    elif cache.is_dir() and not os.access(cache, os.W_OK):
        remedy = "make it writable, or name another with CLEARANCE_KERNEL_CACHE"
        yield Check("compiled code", "warning", f"{cache} cannot be written: every process compiles again", remedy)
    else:
        yield Check("compiled code", "ok", f"{len(files)} files in {cache}")


def _is_whole(path: Path) -> bool:
    try:
        content = path.read_bytes()
    except OSError:
        return False
    return content[-32:] == sha256(content[:-32]).digest()


def _programs(pages: Path) -> Iterator[Check]:
    yield Check("Python", "ok", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    missing = unbuilt(pages)
    if missing:
        yield Check("pages", "failed", missing, "build them, or install a wheel that has them")
    else:
        yield Check("pages", "ok", f"{pages}")
    found = browser()
    if found:
        yield Check("Chromium", "ok", found)
    else:
        remedy = "install it (on Debian: apt install chromium), or print the HTML report from any browser"
        yield Check("Chromium", "warning", "not found, so that no report is printed as PDF", remedy)


NO_WORKER = "no worker is alive, so that runs wait: start `clearance serve` or `clearance worker`"
NO_FOLDER = "the data folder is not there any more: put it back, or start the service again"


def reasons(engine: sa.Engine, data: Path, room: space.Room) -> list[Problem]:
    """Why no run can be done now; none if it can.

    The field is what is missing: `workers`, `space`, `folder`, `schema`, or a kind of `DatabaseOutage`.
    """
    found = []
    if not data.is_dir():
        found.append(Problem("folder", "", NO_FOLDER))
    if why := room.short():
        found.append(Problem("space", "", why))
    try:
        with read(engine) as connection:
            stored, newest = revision.stored(connection), revision.newest()
            if stored != newest:
                sentence = f"the database has schema {stored}, and this version of Clearance needs {newest}"
                found.append(Problem("schema", "", f"{sentence}: start the service again"))
            elif not workers.live(connection):
                found.append(Problem("workers", "", NO_WORKER))
        damage.refuse(engine)
        refuse_read_only(engine)
        space.refuse_full(engine)
    except DatabaseOutage as error:
        found.append(Problem(error.kind, "", error.sentence))
    except OSError:
        found.append(Problem("no-space", "", SENTENCES["no-space"]))
    return found
