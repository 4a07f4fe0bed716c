"""`clearance doctor`: what an installation lacks, each with its remedy."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from clearance.cli._where import DATA, Data, Database

SIGNS = {"ok": "ok", "warning": "warning", "failed": "FAILED"}
FAILED = 1


def doctor(
    data: Data = DATA,
    database: Database = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check an installation: database, space, workers, clock, permissions, programs; exit code 1 if a check fails."""
    from backend.db.engine import default_url
    from backend.health.checks import checks
    from backend.settings import Settings
    from worker.engine.kernels.folder import cache_folder

    pages = os.environ.get("CLEARANCE_PAGES")
    found = checks(data, database or default_url(data), Path(pages) if pages else Settings().pages, cache_folder())
    if as_json:
        typer.echo(json.dumps([asdict(check) for check in found], indent=2))
    else:
        width = max(len(check.name) for check in found)
        for check in found:
            typer.echo(f"{SIGNS[check.state]:<8} {check.name:<{width}}  {check.found}")
            if check.remedy:
                typer.echo(f"{'':<8} {'':<{width}}  -> {check.remedy}")
    raise typer.Exit(FAILED if any(check.state == "failed" for check in found) else 0)
