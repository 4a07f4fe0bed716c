"""`clearance restart RUN`: a way on for a run that waits for the code that began it."""

from __future__ import annotations

from typing import Annotated

import typer

from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened


def restart(
    run: Annotated[str, typer.Argument(metavar="RUN", help="Number of the run, such as R-0001.")],
    keep: Annotated[
        bool, typer.Option("--keep", help="Continue it as a new run, with its evaluations that are still valid.")
    ] = False,
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """Begin a run again that other code began, without its evaluations, or continue it as a new run (--keep)."""

    numbered(run)
    with opened(service, token_file, patience) as client:
        found = client.carry_on(run) if keep else client.restart(run)
        typer.echo(f"{found.id} {found.state}" + (f": continues {found.continues}" if found.continues else ""))
