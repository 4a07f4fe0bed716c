"""`clearance login-link`: a fresh, single-use link for the browser. Start reading at `login_link`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from backend.db import access
from worker.cli._where import DATA, Data, Database, opened

STANDARD = "http://127.0.0.1:8000"

ADDRESS_FILE = "service-address"
"""Where in the data folder the service leaves its address."""


def login_link(
    data: Data = DATA,
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
    """Print a fresh login link, single-use and valid for 15 minutes; earlier unused links are void."""
    with opened(data, database) as connection:
        code = access.create_login_code(connection)
    typer.echo(f"{(url or _serving(data) or STANDARD).rstrip('/')}/login?code={code}")


def _serving(data: Path) -> str:
    """Where the service of this data folder said that it is; empty when it never said so."""
    try:
        return (data / ADDRESS_FILE).read_text().strip()
    except OSError:
        return ""
