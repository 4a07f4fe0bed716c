"""`clearance login-link`: a new, single-use link for the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from backend.db import access, audit
from backend.db.registered import Running, folder, services
from clearance.cli import WrongInputError
from clearance.cli._where import DATA, Database, opened, operator

STANDARD = "http://127.0.0.1:8000"

ADDRESS_FILE = "service-address"
"""The file in the data folder that contains the address of the service."""


def login_link(
    data: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the database; default: that of the running service.",
            envvar="CLEARANCE_DATA",
            file_okay=False,
            show_default=False,
        ),
    ] = None,
    database: Database = "",
    url: Annotated[
        str,
        typer.Option(
            help=f"Address of the service in a browser; default: that of `clearance serve`, or {STANDARD}.",
            envvar="CLEARANCE_PUBLIC_URL",
            show_default=False,
        ),
    ] = "",
) -> None:
    """Print a new login link, single-use and valid for 15 minutes; earlier unused links are revoked."""
    if data is None:
        data = DATA if database else _found()
    with opened(data, database) as connection:
        code = access.create_login_code(connection)
        audit.note_command(connection, operator(), "login_link.made", access.LOCAL, {})
    typer.echo(f"{(url or _serving(data) or STANDARD).rstrip('/')}/login?code={code}")


def _found() -> Path:
    """The data folder of the only service that runs, else the one in this folder; an error names where it searched."""
    here, running = DATA.absolute(), services()
    if any(Path(service.data) == here for service in running):
        return DATA
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
    return _of(running[0])


def _of(service: Running) -> Path:
    if not service.usual:
        raise WrongInputError(
            f"the service at {service.address} has its database outside its data folder: name both, with "
            f"--data {service.data} and --database"
        )
    typer.echo(f"For the service of {service.data}:", err=True)
    return Path(service.data)


def _serving(data: Path) -> str:
    """The recorded address of the service of this data folder; empty if there is none."""
    try:
        return (data / ADDRESS_FILE).read_text().strip()
    except OSError:
        return ""
