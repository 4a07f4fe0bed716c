"""The options for the location of the data, shared by the commands; and who uses them.

A stored run is read where it is: in a folder, in a database, or in a service, which sends the rows of the run.
"""

from __future__ import annotations

import getpass
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, TypeVar

import sqlalchemy as sa
import typer

from backend import secret_settings
from backend.db import alone as locks
from backend.db import revision
from backend.db.engine import connect, connected, default_url, migrate, read
from backend.db.registry import folder, services
from campaigns.refusals import Refusal, RefusalCode
from campaigns.runs import run_name, run_number
from campaigns.unreadable import UNREADABLE
from clearance.cli import WrongInputError, on_disk, refusing
from clearance.cli._service import PATIENCE, numbered
from clearance.cli._service import opened as opened_service

Loaded = TypeVar("Loaded")


def _with_secrets(option_url: str) -> str:
    """The database's URL, with what is in files; raises `WrongInputError`."""
    with refusing(ValueError):
        return secret_settings.database(option_url, os.environ)


Data = Annotated[Path, typer.Option(help="Folder of the database.", envvar="CLEARANCE_DATA", file_okay=False)]
Database = Annotated[
    str,
    typer.Option(
        help="sqlite:///FILE or postgresql://...; the default is clearance.sqlite3 in the data folder.",
        envvar="CLEARANCE_DATABASE",
        callback=_with_secrets,
        show_default=False,
    ),
]

DataServed = Annotated[
    Path | None,
    typer.Option(
        help="Folder of the database; default: `data` here, or that of the running service.",
        envvar="CLEARANCE_DATA",
        file_okay=False,
        show_default=False,
    ),
]

DATA = Path("data")

DAMAGED: tuple[type[Exception], ...] = (sa.exc.SQLAlchemyError, *UNREADABLE)
"""What reading a record may raise that a service has sent."""


def served() -> Path:
    """The data folder of the only service that runs, else the one in this folder; an error names where it searched."""
    here, running = DATA.absolute(), services()
    running = [service for service in running if Path(service.data) == here] or running
    if len(running) > 1:
        listed = "".join(f"\n  --data {service.data}  ({service.address})" for service in running)
        raise WrongInputError(f"{len(running)} services of this user are running; name one of them:{listed}")
    if not running:
        if (DATA / "clearance.sqlite3").exists():
            return DATA
        raise WrongInputError(
            f"no service of this user is running (looked in {folder()}), and there is no database at "
            f"{here / 'clearance.sqlite3'}: start one with `clearance serve`, or name its folder with --data or "
            "CLEARANCE_DATA"
        )
    service = running[0]
    if not service.usual:
        raise WrongInputError(
            f"the service at {service.address} has its database outside its data folder: name both, with "
            f"--data {service.data} and --database"
        )
    if Path(service.data) == here:
        return DATA
    typer.echo(f"For the service of {service.data}:", err=True)
    return Path(service.data)


def url_of(data: Path, database: str, create: bool = True) -> str:
    """The database's URL by the two options; create: whether a missing SQLite file is made now; raises
    `WrongInputError` for an invalid one."""
    url = database or default_url(data)
    with on_disk(f"the folder {data} cannot be used"), refusing(ValueError):
        connect(url, create=create).dispose()
    return url


def existing_url_of(data: Path, database: str, otherwise: str = "") -> str:
    """The URL of an existing database; a missing file raises `WrongInputError` and is not created. otherwise: what the
    message adds."""
    file = data / "clearance.sqlite3"
    if not (database or file.exists()):
        raise WrongInputError(
            f"there is no database at {file}; --data names the folder that `clearance serve` uses{otherwise}",
            RefusalCode.NO_DATABASE,
        )
    return url_of(data, database)


def stored_run(run: str) -> int | None:
    """The number of a stored run from the original text, R-0001 or 1; None for a folder.

    A folder of this name is meant only if `clearance run --out` wrote it: `clearance export` makes one, too, in which
    there is no run to read. ./R-0001 is always a folder.
    """
    number = run_number(run if run.startswith("R-") else f"R-{run}")
    return None if number is None or (Path(run) / "result.json").is_file() else number


Service = Annotated[
    str,
    typer.Option(
        help="Address of the service that has the run, instead of a database.", envvar="CLEARANCE_SERVICE",
        metavar="URL", show_default=False,
    ),
]  # fmt: skip
RECORD = "record.sqlite3"
"""The export of a service that has the stored rows of a run."""


@dataclass(frozen=True)
class StoredRun:
    """A run where it is stored: the folder, or the database with its number; sent: the service that has sent it."""

    place: Path | str
    run_id: int = 0
    sent: str = ""

    def load(self, of_folder: Callable[[Path], Loaded], of_database: Callable[[sa.Connection, int], Loaded]) -> Loaded:
        """Read it; a database is only read."""
        if isinstance(self.place, Path):
            return of_folder(self.place)
        try:
            with reading(self.place) as connection:
                _this_schema(connection, self.sent)
                return of_database(connection, self.run_id)
        except Refusal:
            raise
        except DAMAGED as error:
            if not self.sent:
                raise
            why = getattr(error, "orig", error)
            raise WrongInputError(
                f"{self.sent} has sent a record that cannot be read: {why}", RefusalCode.UNREADABLE
            ) from None


def _this_schema(connection: sa.Connection, sent: str) -> None:
    """Refuses rows of another schema; sent: as of `StoredRun`."""
    stored = revision.stored(connection)
    if stored is None or stored == revision.newest():
        return
    whose = sent or "the database"
    what = f"{whose} has schema {stored}, and this version reads {revision.newest()}; nothing was changed: "
    if stored not in revision.known():
        what += "use the newer version"
    elif sent:
        what += "update that service, or use its version of Clearance"
    else:
        what += "start its service once on a copy of the database, which migrates that, and name the copy with --data"
    raise WrongInputError(what, RefusalCode.OTHER_SCHEMA)


@contextmanager
def stored_in(
    ctx: typer.Context, run: str, data: Path, database: str, service: str, token_file: str
) -> Iterator[StoredRun]:
    """A run of a folder, of the database, or of a service, whose record is deleted at the end.

    Stated options are preferred to the environment, and there a database to a service.
    """
    known = stored_run(run)
    if _from_service(ctx, known, service):
        name = numbered(run) if known is None else run_name(known)
        with TemporaryDirectory(prefix="clearance-record-", ignore_cleanup_errors=True) as folder:
            with opened_service(service, token_file, PATIENCE) as client:
                (file,) = client.export(name, Path(folder), (RECORD,))
            yield StoredRun(f"sqlite:///{file}", run_number(name) or 0, service)
        return
    if known is None:
        yield StoredRun(Path(run))
        return
    otherwise = "; --service names the service of the run"
    otherwise += f", and ./{run} is the folder of this name" if Path(run).is_dir() else ""
    yield StoredRun(existing_url_of(data, database, otherwise), known)


def _from_service(ctx: typer.Context, run_id: int | None, service: str) -> bool:
    """Whether a run is read from the service; `WrongInputError` if a database is stated, too."""
    stated, *known = (_source(ctx, option) for option in ("service", "data", "database"))
    if stated == "COMMANDLINE" and "COMMANDLINE" in known:
        raise WrongInputError(
            "--service reads the run from a service: leave --data and --database out", RefusalCode.OPTIONS
        )
    usual = known == ["DEFAULT"] * 2 and not os.environ.get(secret_settings.DATABASE + secret_settings.FILE)
    return bool(service) and (stated == "COMMANDLINE" or (usual and run_id is not None))


def _source(ctx: typer.Context, option: str) -> str:
    """COMMANDLINE, ENVIRONMENT or DEFAULT."""
    found = ctx.get_parameter_source(option)
    return "DEFAULT" if found is None else found.name


@contextmanager
def reading(url: str) -> Iterator[sa.Connection]:
    """A read transaction on the database."""
    with connected(url) as engine, read(engine) as connection:
        yield connection


@contextmanager
def opened(data: Path, database: str, *, create: bool = False) -> Iterator[sa.Connection]:
    """A write transaction on the database; unless it is to be created, a missing one is `WrongInputError`."""
    url = url_of(data, database) if create else existing_url_of(data, database)
    migrate(url)
    with connected(url) as engine, engine.begin() as connection:
        yield connection


def operator() -> str:
    """The operating-system user, whom the audit trail names; `unknown` where there is none, as in some containers."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"


def confirmed(question: str, otherwise: str = "") -> bool:
    """Whether the user agrees; otherwise: what the error adds where there is no terminal."""
    try:
        return typer.confirm(question)
    except typer.Abort:
        text = f"no confirmation was given; use --yes where there is no terminal{otherwise}"
        raise WrongInputError(text) from None


def counted(number: int, what: str) -> str:
    """A number of things, such as 1 run or 20 runs."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


@contextmanager
def alone(data: Path | None, url: str) -> Iterator[None]:
    """Locks data folder and database against another `clearance serve`; an error if a service without one uses them."""
    with locks.alone(data, url, "serve.lock"):
        with locks.alone(data, url, "backend.lock"):
            pass  # free for the service that is started next
        yield
