"""The options of commands that use a service, and its client; its errors become those of the command line."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clearance.cli import UnreachableError, WrongInputError

if TYPE_CHECKING:
    from clearance.client import Client

Service = Annotated[
    str, typer.Option(help="Address of the service.", envvar="CLEARANCE_SERVICE", metavar="URL", show_default=True)
]
SERVICE = "http://127.0.0.1:8000"
Token = Annotated[
    str,
    typer.Option(
        "--token-file", metavar="FILE", show_default=False,
        help="File with an API token; default: the token in CLEARANCE_TOKEN.",
    ),
]  # fmt: skip
PATIENCE = 120.0
Patience = Annotated[
    float, typer.Option(help="How long to retry while the service does not answer (seconds).", min=0.0)
]


def token_of(file: str) -> str:
    """The token of a file, or that of the environment; empty if there is none, which the client refuses."""
    found = os.environ.get("CLEARANCE_TOKEN", "")
    if file:
        try:
            found = Path(file).read_text("utf-8")
        except (OSError, ValueError) as error:
            raise WrongInputError(f"the token's file {file} cannot be read: {error}") from None
    return found.strip()


def _noticed(text: str) -> None:
    """Print a text on standard error, on a terminal in place of the line of a stage."""
    typer.echo(f"\r\033[K{text}" if sys.stderr.isatty() else text, err=True)


@contextmanager
def opened(service: str, token_file: str, patience: float, source: str = "") -> Iterator[Client]:
    """The client; source: the campaign file, in whose problems a refusal is reported."""
    from campaigns import CampaignError, Problem
    from clearance import client

    try:
        with client.Client(service, token_of(token_file), patience=patience) as made:
            made.session.notify = _noticed
            yield made
    except client.UnreachableError as error:
        raise UnreachableError(f"{error}") from None
    except client.InvalidCampaignError as error:
        if not source:
            raise WrongInputError(f"{error}") from None
        problems = [Problem(p.field.removeprefix("campaign."), p.given, p.message) for p in error.problems]
        raise CampaignError(source, problems) from None
    except client.ClearanceError as error:
        raise WrongInputError(f"{error}", getattr(error, "kind", "")) from None


def numbered(run: str) -> str:
    """The run as given; `WrongInputError` if it is not the number of one."""
    from campaigns.runs import run_number

    if run_number(run) is None:
        raise WrongInputError(f"invalid run number {run!r}: give one such as R-0001")
    return run
