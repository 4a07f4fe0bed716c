"""`clearance login-link`: a fresh link, good once, for the browser. Start reading at `login_link`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from backend.db import access
from worker.cli._where import DATA, Data, Database, opened

STANDARD = "http://127.0.0.1:8000"


def login_link(
    data: Data = DATA,
    database: Database = "",
    url: Annotated[
        str,
        typer.Option(
            help=f"Where a browser reaches the service; by default where `clearance serve` says, or {STANDARD}.",
            envvar="CLEARANCE_PUBLIC_URL",
            show_default=False,
        ),
    ] = "",
) -> None:
    """Print a fresh login link, good once and for 12 hours."""
    with opened(data, database) as connection:
        code = access.create_login_code(connection)
    typer.echo(link(url or _serving(data) or STANDARD, code))


def link(url: str, code: str) -> str:
    """The address that logs a browser in."""
    return f"{url.rstrip('/')}/login?code={code}"


def serving_file(data: Path) -> Path:
    """Where a running `clearance serve` says what its address is."""
    return data / "serve.json"


def _serving(data: Path) -> str:
    try:
        return str(json.loads(serving_file(data).read_text())["url"])
    except (OSError, ValueError, KeyError):
        return ""
