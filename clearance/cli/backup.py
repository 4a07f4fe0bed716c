"""`clearance backup FILE`: copies the database into one file while runs write to it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from clearance.cli._where import DATA, Data, Database, existing_url_of


def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A new file.", dir_okay=False)],
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Copy the database into one file; the service and its workers go on. `clearance restore` puts it back."""
    from backend.db.backup import backup as copied

    url = existing_url_of(data, database)
    began = time.monotonic()
    size = copied(url, file)
    typer.echo(f"{file}: {size / 1e6:.1f} MB in {time.monotonic() - began:.1f} s.")
