"""`clearance cancel RUN...`: cancels runs of a service."""

from __future__ import annotations

from typing import Annotated

import typer

from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened


def cancel(
    runs: Annotated[list[str], typer.Argument(metavar="RUN...", help="Numbers of the runs, such as R-0001.")],
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """Cancel runs of a service; those that have ended are unchanged."""

    from clearance.cli._following import ended_as

    for run in runs:
        numbered(run)
    with opened(service, token_file, patience) as client:
        for run in runs:
            found = client.cancel(run)
            typer.echo(f"{found.id} {found.state}" + (f": {ended_as(found)}" if found.verdict else ""))
