"""`clearance export RUN`: saves the files of a run of a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clearance.cli._following import FILES
from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token


def export(
    run: Annotated[str, typer.Argument(help="Number of the run, such as R-0001.")],
    out: Annotated[Path, typer.Option(help="Folder for the files; default: R-0001.", file_okay=False)] = Path(),
    file: Annotated[
        list[str] | None,
        typer.Option(help=f"A file, may be repeated; by default {', '.join(FILES)}.", show_default=False),
    ] = None,
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:  # fmt: skip
    """Save the files of a run of a service: campaign, tables, traces, report, picture."""
    from clearance.cli import WrongInputError
    from clearance.cli._following import save
    from clearance.cli._out import writable
    from clearance.cli._service import numbered, opened
    from clearance.client.calls import FILES as KNOWN

    numbered(run)
    wanted = tuple(dict.fromkeys(file or FILES))
    unknown = [name for name in wanted if name not in KNOWN]
    if unknown:
        raise WrongInputError(f"there is no file {unknown[0]!r} of a run; there are {', '.join(KNOWN)}")
    folder = out if out != Path() else Path(run)
    writable(folder)
    with opened(service, token_file, patience) as client:
        for path in save(client, run, folder, wanted):
            typer.echo(str(path))
