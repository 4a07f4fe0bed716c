"""`clearance login-link`: a new, single-use link for the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clearance.cli._service import SERVICE
from clearance.cli._where import DATA, Database, DataServed, opened, operator, served

ADDRESS_FILE = "service-address"
"""The file in the data folder that contains the address of the service."""


def login_link(
    data: DataServed = None,
    database: Database = "",
    url: Annotated[
        str,
        typer.Option(
            help=f"Address of the service in a browser; default: that of `clearance serve`, or {SERVICE}.",
            envvar="CLEARANCE_PUBLIC_URL",
            show_default=False,
        ),
    ] = "",
) -> None:
    """Print a new login link, single-use and valid for 15 minutes; earlier unused links are revoked."""
    from backend.db import access, audit
    from backend.db.roles import LOCAL

    if data is None:
        data = DATA if database else served()
    with opened(data, database) as connection:
        code = access.create_login_code(connection)
        audit.note_command(connection, operator(), "login_link.made", LOCAL, {})
    typer.echo(f"{(url or _serving(data) or SERVICE).rstrip('/')}/login?code={code}")


def _serving(data: Path) -> str:
    """The recorded address of the service of this data folder; empty if there is none."""
    try:
        return (data / ADDRESS_FILE).read_text().strip()
    except OSError:
        return ""
