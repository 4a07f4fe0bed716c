"""`clearance token create|list|revoke`: API tokens for programs (RFC 6750)."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from backend.db import access
from worker.cli._where import DATA, Data, Database, opened

app = typer.Typer(help="API tokens for programs: create, list, revoke.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="What the token is for, such as ci.")]


@app.command()
def create(name: Name, data: Data = DATA, database: Database = "") -> None:
    """Create a token and print it: the only time it is shown. Send it as `Authorization: Bearer TOKEN`."""
    with opened(data, database, create=True) as connection:
        token = access.create_token(connection, name)
    typer.echo(f"Token {name!r}, shown only once:", err=True)
    typer.echo(token)


@app.command("list")
def list_(data: Data = DATA, database: Database = "") -> None:
    """List the tokens: name, created, last used, revoked."""
    with opened(data, database) as connection:
        rows = access.tokens(connection)
    table = [("name", "created", "last used", "revoked")]
    table += [(row.name, _shown(row.created), _shown(row.last_used), _shown(row.revoked)) for row in rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for line in table:
        typer.echo("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


@app.command()
def revoke(name: Name, data: Data = DATA, database: Database = "") -> None:
    """Revoke a token: from now on it is refused."""
    with opened(data, database) as connection:
        access.revoke_token(connection, name)
    typer.echo(f"Token {name!r} was revoked.")


def _shown(at: float | None) -> str:
    return "-" if at is None else time.strftime("%Y-%m-%d %H:%M", time.localtime(at))
