"""The options for the location of the data, shared by the commands; and who uses them."""

from __future__ import annotations

import getpass
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, TypeVar

import sqlalchemy as sa
import typer

from backend.db.engine import connect, default_url, migrate, read
from campaigns.refusals import RefusalCode
from campaigns.runs import run_number
from clearance.cli import WrongInputError

Loaded = TypeVar("Loaded")

Data = Annotated[Path, typer.Option(help="Folder of the database.", envvar="CLEARANCE_DATA", file_okay=False)]
Database = Annotated[
    str,
    typer.Option(
        help="sqlite:///FILE or postgresql://...; the default is clearance.sqlite3 in the data folder.",
        envvar="CLEARANCE_DATABASE",
        show_default=False,
    ),
]

DATA = Path("data")


def url_of(data: Path, database: str) -> str:
    """The database's URL by the two options; raises `WrongInputError` for an invalid one."""
    url = database or default_url(data)
    try:
        connect(url).dispose()
    except ValueError as error:
        raise WrongInputError(f"{error}") from None
    except OSError as error:
        raise WrongInputError(f"the folder {data} cannot be used: {error.strerror}") from None
    return url


def existing_url_of(data: Path, database: str) -> str:
    """The URL of an existing database; a missing file raises `WrongInputError` and is not created."""
    file = data / "clearance.sqlite3"
    if not (database or file.exists()):
        raise WrongInputError(
            f"there is no database at {file}; --data names the folder that `clearance serve` uses",
            RefusalCode.NO_DATABASE,
        )
    return url_of(data, database)


def stored_run(run: str) -> int | None:
    """The number of a stored run from the original text, R-0001 or 1; None for a folder."""
    return None if Path(run).is_dir() else run_number(run if run.startswith("R-") else f"R-{run}")


def loaded_run(
    run: str, data: Path, database: str,
    of_folder: Callable[[Path], Loaded], of_database: Callable[[sa.Connection, int], Loaded],
) -> Loaded:  # fmt: skip
    """A run of a folder, or of the database, which is only read."""
    run_id = stored_run(run)
    if run_id is None:
        return of_folder(Path(run))
    with reading(existing_url_of(data, database)) as connection:
        return of_database(connection, run_id)


@contextmanager
def reading(url: str) -> Iterator[sa.Connection]:
    """A read transaction on the database."""
    engine = connect(url)
    try:
        with read(engine) as connection:
            yield connection
    finally:
        engine.dispose()


@contextmanager
def opened(data: Path, database: str, *, create: bool = False) -> Iterator[sa.Connection]:
    """A write transaction on the database; unless it is to be created, a missing one is `WrongInputError`."""
    url = url_of(data, database) if create else existing_url_of(data, database)
    migrate(url)
    engine = connect(url)
    try:
        with engine.begin() as connection:
            yield connection
    finally:
        engine.dispose()


def operator() -> str:
    """The operating-system user, whom the audit trail names; `unknown` where there is none, as in some containers."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"


def counted(number: int, what: str) -> str:
    """A number of things, such as 1 run or 20 runs."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
