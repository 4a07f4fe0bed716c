"""`clearance follow RUN`: follows a run of a service to its verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from clearance.cli import _launch as launch
from clearance.cli._following import AsJson, Out, follow_to_the_end, refuse_out, saves
from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened


def follow(
    run: Annotated[str, typer.Argument(help="Number of the run, such as R-0001.")],
    service: Service = SERVICE,
    token_file: Token = "",
    out: Out = None,
    as_json: AsJson = False,
    patience: Patience = PATIENCE,
    junit: launch.Junit = None,
    summary: launch.Summary = None,
    sarif: launch.Sarif = None,
) -> None:
    """Wait for the verdict of a run of a service, which is the exit code."""
    from clearance.cli._out import writable

    numbered(run)
    writable(out)
    options = launch.Launch.read(None, None, junit, summary, sarif, out, saves)
    refuse_out(out, summary)
    with opened(service, token_file, patience) as client:
        raise typer.Exit(follow_to_the_end(client, client.run(run), out, as_json, options))
