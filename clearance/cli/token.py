"""`clearance token create|list|revoke`: API tokens for programs (RFC 6750)."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from backend.db.roles import LOCAL, Scope
from clearance.cli._following import aligned
from clearance.cli._where import DATA, Database, DataServed, opened, operator, served

app = typer.Typer(help="API tokens for programs: create, list, revoke.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="What the token is for, such as ci.")]


@app.command()
def create(
    name: Name,
    scope: Annotated[
        Scope,
        typer.Option(
            help="What it permits: read; run, that is also launching and cancelling; admin, everything but what needs "
            "a browser."
        ),
    ] = "run",
    owner: Annotated[str, typer.Option(help="The user whose role limits it.")] = LOCAL,
    days: Annotated[
        int | None, typer.Option(min=1, max=3650, help="Days until it expires; default: never.", show_default=False)
    ] = None,
    data: DataServed = None,
    database: Database = "",
) -> None:
    """Create a token and print it: the only time it is shown. Send it as `Authorization: Bearer TOKEN`."""
    from backend.db import access, audit

    with opened(_folder(data, database), database, create=True) as connection:
        token = access.create_token(connection, name, owner, scope, None if days is None else days * 86400.0)
        details = {"owner": owner, "scope": scope, "days": days}
        audit.note_command(connection, operator(), "token.created", name, details)
    typer.echo(f"Token {name!r}, shown only once:", err=True)
    typer.echo(token)


@app.command("list")
def list_(data: DataServed = None, database: Database = "") -> None:
    """List the tokens: name, owner, scope, created, expires, last used, revoked."""
    from backend.db import access

    with opened(_folder(data, database), database) as connection:
        rows = access.tokens(connection)
    table: list[tuple[str, ...]] = [("name", "owner", "scope", "created", "expires", "last used", "revoked")]
    for row in rows:
        times = (row.created, row.expires, row.last_used, row.revoked)
        table.append((row.name, row.owner, row.scope, *map(_shown, times)))
    typer.echo("\n".join(aligned(table)))


@app.command()
def revoke(name: Name, data: DataServed = None, database: Database = "") -> None:
    """Revoke a token: from now on it is refused."""
    from backend.db import access, audit

    with opened(_folder(data, database), database) as connection:
        access.revoke_token(connection, name)
        audit.note_command(connection, operator(), "token.revoked", name, {})
    typer.echo(f"Token {name!r} was revoked.")


def _folder(stated: Path | None, database: str) -> Path:
    if stated is not None:
        return stated
    return DATA if database or (DATA / "clearance.sqlite3").exists() else served()


def _shown(at: float | None) -> str:
    return "-" if at is None else time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(at))
