"""`clearance purge`: permanently deletes the results of runs, by age of their removal and by size; frees the space."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.runs import run_name
from clearance.cli import VIOLATED, WrongInputError
from clearance.cli._where import DATA, Data, Database, confirmed, counted, existing_url_of, operator

if TYPE_CHECKING:
    import sqlalchemy as sa

    from backend.db.purge import Removed

UNITS = {"h": 3600.0, "d": 86400.0, "w": 7 * 86400.0}
LISTED = 20
"""Runs that are listed individually; of the others only the number."""

WORTH, SHARE = 1 << 20, 0.1
"""Unused space above which an SQLite file is rewritten: [bytes], and as a fraction of it."""


def purge(
    older_than: Annotated[
        str,
        typer.Option(
            help="Minimum time since removal: 90d, 12h, 2w; 0d means every removed run.",
            envvar="CLEARANCE_RETENTION_AGE",
        ),
    ] = "90d",
    size: Annotated[
        str,
        typer.Option(
            help="What may be stored at most, such as 50GB (units: B, kB, MB, GB, TB; one is needed): above it the "
            "oldest ended runs go as well, even if they were not removed, except those that are signed off, pinned, a "
            "baseline, or of a requirement.",
            envvar="CLEARANCE_RETENTION_SIZE",
            show_default=False,
        ),
    ] = "",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only print what would be deleted.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask for confirmation.")] = False,
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Permanently delete the results of runs removed long ago, and of the oldest above a size; their history stays.

    Exit code 1: more is stored than the size permits, because the rest may not go.
    """
    age, limit = _age(older_than), _limit(size)
    url = existing_url_of(data, database)
    from backend.db import purge as stored
    from backend.db.engine import connected, migrate

    migrate(url)
    with connected(url) as engine:
        old = stored.due(engine, age)
        above = None if limit is None else stored.beyond(engine, limit, old)
        _tell(old, f"There is no run to purge that was removed more than {older_than} ago.")
        if above is not None:
            _tell(above.runs, f"{_size(above.occupied)} are stored, of {size}: no further run is purged.")
        runs = [*old, *(above.runs if above else ())]
        question = f"Delete the results of {counted(len(runs), 'run')}? This cannot be undone."
        if dry_run or not (yes or not runs or confirmed(question, ". Nothing was deleted")):
            typer.echo("Nothing was deleted: this was a dry run." if dry_run else "Nothing was deleted.")
            rest = above.left if above else 0
        else:
            why = f"retention by size: more than {size} were stored"
            gone = [run for run in old if stored.purge(engine, run.id, age, operator())]
            for run in runs[len(old) :]:
                if limit is not None and stored.exceeded(engine, limit):
                    gone += [run] if stored.purge(engine, run.id, None, operator(), why) else []
            if runs:
                typer.echo(f"{counted(len(gone), 'run')} purged.")
            _reclaim(engine)
            rest = 0 if limit is None else stored.beyond(engine, limit).occupied - limit
    if rest > 0:
        typer.echo(
            f"The size of {size} is exceeded by {_size(rest)}: the other runs are in progress, signed off, pinned, a "
            "baseline, or of a requirement, or it is what the database needs by itself. Remove or release what is not "
            "needed, or permit more.",
            err=True,
        )
        raise typer.Exit(VIOLATED)


def _limit(text: str) -> int | None:
    """The bytes of a size such as 50GB; None for none. A number without a unit is refused: 50 bytes purge every run."""
    if not text:
        return None
    found = re.fullmatch(r"(\d{1,18}) ?([kMGT]?B)", text)
    if found is None:
        what = "has no unit" if text.isdecimal() else "is not a size"
        raise WrongInputError(
            f"--size (CLEARANCE_RETENTION_SIZE) {text!r} {what}; give 50GB: a whole number with B, kB, MB, GB or TB"
        )
    power = " kMGT".index(found[2][:-1] or " ")
    return int(int(found[1]) * 1000**power)


def _age(text: str) -> float:
    """The seconds of an age such as 90d."""
    found = re.fullmatch(r"(\d{1,5})([hdw])", text)
    if found is None:
        raise WrongInputError(
            f"--older-than {text!r} is not a length of time of up to five digits; give 90d for days, 12h for hours, 2w "
            "for weeks"
        )
    return int(found[1]) * UNITS[found[2]]


def _tell(runs: list[Removed], none: str) -> None:
    if not runs:
        typer.echo(none)
        return
    for run in runs[:LISTED]:
        removed = run.removed is not None
        day = time.strftime("%Y-%m-%d", time.gmtime(run.removed if removed else run.finished))
        typer.echo(
            f"{run_name(run.id)}  {f'removed {day} by {run.removed_by}' if removed else f'ended {day}'}  "
            f"{run.evaluations:,} evaluations, {_size(run.size)}  "
            f"{run.name}{f': {run.removed_reason}' if removed else ''}"
        )
    if len(runs) > LISTED:
        typer.echo(f"and {len(runs) - LISTED} more")
    typer.echo(f"{counted(len(runs), 'run')}, {_size(sum(run.size for run in runs))} of evaluations and trajectories.")


def _reclaim(engine: sa.Engine) -> None:
    """Reduce the size of the file if worthwhile, and print by how much."""
    import sqlite3

    from backend.db import purge as stored
    from backend.db.engine import is_sqlite

    if not is_sqlite(engine):
        typer.echo("PostgreSQL reuses the space (autovacuum).")
        return
    unused = stored.unused(engine)
    worth = unused.size >= WORTH and unused.share >= SHARE
    if not worth or unused.in_flight:
        later = ": it is not made smaller now, because that would stop what a running run stores" if worth else ""
        typer.echo(f"{_size(unused.size)} of the file are free and will be reused{later}.")
        return
    try:
        space = stored.reclaim(engine)
    except sqlite3.OperationalError as error:
        typer.echo(
            f"The file still has {_size(unused.size)} of free space and could not be rewritten ({error}): "
            "run `clearance purge` again when no run is running, with free disk space of at least the file's size.",
            err=True,
        )
        return
    typer.echo(f"The file was reduced from {_size(space.before)} to {_size(space.after)}.")


def _size(number: float) -> str:
    return f"{number / 1e6:.1f} MB" if number >= 1e5 else f"{number / 1e3:.1f} kB"
