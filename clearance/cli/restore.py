"""`clearance restore FILE`: puts a backup in the place of the database."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import sqlalchemy as sa
import typer

from clearance.cli._where import DATA, Data, Database, alone, confirmed, url_of


def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A file of `clearance backup`.", dir_okay=False)],
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask for confirmation.")] = False,
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Put a backup in the place of the database; the former SQLite file is kept under another name."""
    from backend.db.backup import restore as put_back

    url = url_of(data, database, create=False)
    shown = sa.make_url(url).render_as_string(hide_password=True)
    if not yes and not confirmed(f"Replace the database {shown}?"):
        typer.echo("Nothing was changed.")
        return
    with alone(data if data.is_dir() else None, url):
        found = put_back(url, file)
    typer.echo(f"Restored {file}." + (f" The former database is {found.former}." if found.former else ""))
    typer.echo(_numbering(found.numbers))
    typer.echo("All sessions, login links and unused invitations have ended. As of the backup,")
    typer.echo(f"valid tokens: {', '.join(found.tokens) or 'none'}")
    typer.echo(f"enabled users, with the passwords of then: {', '.join(found.users) or 'none'}")
    typer.echo("Revoke and disable again what was revoked or disabled since (Tokens and Users on the pages).")


def _numbering(last: dict[str, int] | None) -> str:
    """Whether numbers may be given again, a sentence."""
    from campaigns.runs import run_name, sweep_name

    if last is None:
        return "Numbers that were given since the backup may be given again: no former database was continued."
    run, sweep = (last.get(table, 0) + 1 for table in ("runs", "sweeps"))
    return (
        f"New runs are numbered from {run_name(run)} and new sweeps from {sweep_name(sweep)}, "
        "above those of the former database."
    )
