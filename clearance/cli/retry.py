"""`clearance retry RUN...`: queues failed runs of a service again."""

from __future__ import annotations

from typing import Annotated

import typer

from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened


def retry(
    runs: Annotated[list[str], typer.Argument(metavar="RUN...", help="Numbers of the runs, such as R-0001.")],
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """Queue failed runs of a service again; they go on from their stored evaluations, if any has a value."""

    for run in runs:
        numbered(run)
    with opened(service, token_file, patience) as client:
        for run in runs:
            found = client.retry(run)
            typer.echo(f"{found.id} {found.state}")
