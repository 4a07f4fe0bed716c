"""`clearance verify RUN`: the earlier name of `clearance audit RUN`, for one version."""

from __future__ import annotations

from typing import Annotated

import typer

from clearance.cli._where import DATA, Data, Database
from clearance.cli.audit import audit, renamed


def verify(
    ctx: typer.Context,
    run: Annotated[str, typer.Argument(help="As for `clearance audit`.")],
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Deprecated: use `clearance audit`. Removed in the next version."""
    renamed("verify", "audit")
    audit(ctx, run, data=data, database=database)
