"""`clearance follow RUN`: follows a run of a service to its verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from worker.cli._following import PATIENCE, SERVICE, AsJson, Out, Patience, Service, Token


def follow(
    run: Annotated[str, typer.Argument(help="Its number, such as R-0001.")],
    service: Service = SERVICE,
    token_file: Token = "",
    out: Out = None,
    as_json: AsJson = False,
    patience: Patience = PATIENCE,
) -> None:
    """Wait for the verdict of a run of a service, which is the exit code."""
    from campaigns.runs import run_number
    from worker.cli import WrongInputError
    from worker.cli._following import follow_to_the_end, token_of
    from worker.cli._out import writable
    from worker.cli._remote import Remote

    if run_number(run) is None:
        raise WrongInputError(f"invalid run number {run!r}: give one such as R-0001")
    writable(out)
    with Remote(service, token_of(token_file), patience) as remote:
        raise typer.Exit(follow_to_the_end(remote, remote.run(run)["id"], out, as_json))
