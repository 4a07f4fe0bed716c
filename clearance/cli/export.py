"""`clearance export RUN`: saves the files of a run of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clearance.cli import refusing
from clearance.cli._following import FILES, save
from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened


def export(
    run: Annotated[str, typer.Argument(help="Number of the run, such as R-0001.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for the files; default: R-0001.", file_okay=False, show_default=False),
    ] = None,
    file: Annotated[
        list[str] | None,
        typer.Option(help=f"A file, may be repeated; by default {', '.join(FILES)}.", show_default=False),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Print which files the run has, and save none.")] = False,
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:  # fmt: skip
    """Save files of a run of a service: by default its campaign, result, evaluations, findings and report."""
    from clearance.cli._exports import refuse_to_replace
    from clearance.cli._out import writable
    from clearance.client import calls

    numbered(run)
    folder = Path(run) if out is None else out
    names = tuple(dict.fromkeys(file or FILES))
    with refusing(ValueError):
        for name in names:
            calls.file(run, name)
    if folder.exists() and not list_:  # else it is made with the first file that the service sends
        writable(folder)
        refuse_to_replace(folder, names)
    with opened(service, token_file, patience) as client:
        if list_:
            lines = [f"{one.file:28} {one.unavailable or one.title}" for one in client.exports(run)]
            typer.echo("\n".join(["campaign.yaml                Campaign", *lines]))
            return
        for path in save(client, run, folder, names):
            typer.echo(str(path))
