"""`clearance trail verify|head`: verifies the hash chain of the audit trail; nothing is written."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import sqlalchemy as sa
import typer

from backend.db.chain import COVERED, FIRST, Head, Verified, head, verify
from backend.db.outages import DatabaseOutage
from campaigns.refusals import RefusalCode
from clearance.cli import VIOLATED, WrongInputError, refusing
from clearance.cli._where import DATA, Data, Database, existing_url_of, reading

CANNOT = (
    "This shows that no row was changed, removed or reordered after it was written, unless whoever did so computed all "
    "later hashes again, which anyone who may write the database can do. A head that was noted elsewhere, given with "
    "--head, shows that too."
)


app = typer.Typer(help="The audit trail of the service.", no_args_is_help=True)


@app.command("verify")
def verify_trail(
    noted: Annotated[
        str, typer.Option("--head", metavar="NUMBER:HASH", help="A head that was noted earlier.", show_default=False)
    ] = "",
    file: Annotated[
        Path | None,
        typer.Option("--file", help="An exported trail instead of the database.", dir_okay=False, show_default=False),
    ] = None,
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Verify the audit trail of the service, and name the first 20 rows that were changed, removed or reordered.

    The exit code is 0 if the chain is unbroken, 1 if it is broken, 3 if there is no trail.
    """
    with refusing(ValueError):
        expected = head(noted) if noted else None
    found = _of_database(data, database, expected) if file is None else _of_file(file, expected)
    for fault in found.faults:
        typer.echo(f"{fault[0].upper()}{fault[1:]}.")
    if found.faults:
        raise typer.Exit(VIOLATED)
    rows = "1 row" if found.head.row == 1 else f"{found.head.row:,} rows"
    typer.echo(f"The audit trail is unbroken: {rows}.")
    typer.echo(f"Head: {found.head}")
    if expected is None:
        typer.echo(CANNOT)


@app.command("head")
def print_head(data: Data = DATA, database: Database = "") -> None:
    """Print number and hash of the newest row, to be noted where the service cannot write."""
    from backend.db import audit

    with reading(existing_url_of(data, database)) as reader:
        _migrated(reader)
        typer.echo(str(audit.head(reader)))


def _of_database(data: Path, database: str, noted: Head | None) -> Verified:
    from backend.db import audit

    try:
        with reading(existing_url_of(data, database)) as reader:
            _migrated(reader)
            return audit.verified(reader, noted)
    except DatabaseOutage:  # nothing is known of the trail
        raise
    except sa.exc.DBAPIError as error:  # such as text that is not UTF-8
        return Verified([f"the trail cannot be read to its end: {error.orig}"], Head(0, FIRST))


def _of_file(file: Path, noted: Head | None) -> Verified:
    try:
        with file.open(encoding="utf-8") as lines:
            found = verify(_rows(file, lines), noted=noted)
    except (OSError, UnicodeDecodeError) as error:
        raise WrongInputError(f"the file {file} cannot be read: {error}") from None
    if not found.head.row:
        raise WrongInputError(
            f"the file {file} has no row, but an export has at least its own: save `GET /api/v1/audit/export` again",
            RefusalCode.NO_TRAIL,
        )
    return found


def _rows(file: Path, lines: Any) -> Iterator[dict[str, Any]]:
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
        except (ValueError, RecursionError):
            row = None
        whole = isinstance(row, dict) and {*COVERED, "hash"} <= row.keys() and type(row["id"]) is int
        if not whole or not isinstance(row["hash"], str):
            raise WrongInputError(
                f"{file}, line {number}: not a row of an audit trail; give a file of `GET /api/v1/audit/export`",
                RefusalCode.NO_TRAIL,
            )
        yield row


def _migrated(reader: sa.Connection) -> None:
    if not sa.inspect(reader).has_table("audit_head"):
        raise WrongInputError(
            "this database is of an earlier version, whose audit trail has no hashes: start the service once, which "
            "migrates it"
        )
