"""The output of `clearance submit` and `clearance follow`: progress, the verdict, the files of a run.

Start reading at `follow_to_the_end`.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.documents import JsonObject
from worker.cli import CODES, INTERNAL, INTERRUPTED, UnreachableError, WrongInputError

if TYPE_CHECKING:
    from worker.cli._remote import Remote

FILES = {
    "campaign.yaml": "runs/{run}/campaign.yaml",
    "run.json": "runs/{run}/exports/run.json",
    "evaluations.csv": "runs/{run}/exports/evaluations.csv",
    "findings.csv": "runs/{run}/exports/findings.csv",
    "report.html": "runs/{run}/report.html",
}
"""Files of a run that are saved, and their address in the service."""

Service = Annotated[
    str, typer.Option(help="Address of the service.", envvar="CLEARANCE_SERVICE", metavar="URL", show_default=True)
]
SERVICE = "http://127.0.0.1:8000"
Token = Annotated[
    str,
    typer.Option(
        "--token-file", metavar="FILE", show_default=False,
        help="File that holds an API token; else the token is in CLEARANCE_TOKEN.",
    ),
]  # fmt: skip
Out = Annotated[Path | None, typer.Option(help=f"Folder for the run's files: {', '.join(FILES)}.", file_okay=False)]
PATIENCE = 120.0
Patience = Annotated[float, typer.Option(help="How long to retry while the service does not answer [s].", min=0.0)]
AsJson = Annotated[bool, typer.Option("--json", help="Print only the run's JSON, as the API returns it.")]


def token_of(file: str) -> str:
    """The token of a file, or that of the environment; `WrongInputError` if there is none."""
    found = os.environ.get("CLEARANCE_TOKEN", "")
    if file:
        try:
            found = Path(file).read_text("utf-8")
        except (OSError, ValueError) as error:
            raise WrongInputError(f"the token's file {file} cannot be read: {error}") from None
    token = found.strip()
    if not token:
        raise WrongInputError(
            "no API token: set CLEARANCE_TOKEN or give --token-file; `clearance token create ci` makes one"
        )
    if not token.isascii() or not token.isprintable() or " " in token:
        raise WrongInputError("invalid API token: it must be one ASCII word; `clearance token create ci` prints one")
    return token


def follow_to_the_end(service: Remote, run: str, out: Path | None, as_json: bool) -> int:
    """Show a run until it has ended, save its files; returns the exit code."""
    try:
        document = _shown(service, run, quiet=as_json)
    except (KeyboardInterrupt, UnreachableError):
        typer.echo(f"{run} continues in the background; `clearance follow {run}` follows it again", err=True)
        raise
    # Before the files, which the service may be unable to deliver.
    typer.echo(json.dumps(document, indent=2) if as_json else "\n".join(_ended(service, document)))
    if out is not None:
        for name, path in FILES.items():
            service.save(path.format(run=run), out / name)
        typer.echo(f"Files in {out}", err=True)
    if document["state"] == "done":
        return CODES[document["verdict"]]
    return INTERRUPTED if document["state"] == "cancelled" else INTERNAL


def _shown(service: Remote, run: str, quiet: bool) -> JsonObject:
    """The run once it has ended; until then a line for every stage, in place where that is a terminal."""
    live, before, document = not quiet and sys.stderr.isatty(), "", {}
    for document in service.followed(run):
        line = _line(document, figures=live)
        if quiet or line == before:
            continue
        typer.echo(f"\r\033[K{line}" if live else line, err=True, nl=not live)
        before = line
    if live and before:
        typer.echo("\r\033[K", err=True, nl=False)
    return document


def _line(document: JsonObject, figures: bool) -> str:
    stage = document["stage"]
    if document["state"] != "running" or stage is None:
        return f"{document['id']} {document['state']}"
    name = stage["kind"] if stage["method"] is None else f"{stage['kind']}: {stage['method']}"
    if not figures:
        return f"{document['id']} {name}"
    best = "" if stage["best"] is None else f", best {stage['best']:.6g} {document['unit']}"
    return f"{document['id']} {name}, {stage['evaluations']:,} of at most {stage['planned']:,} evaluations{best}"


def _counts(document: JsonObject) -> str:
    """How many evaluations there are; a service of an earlier version does not report the excluded ones."""
    excluded = document.get("excluded_evaluations")
    left_out = "" if excluded is None else f", {excluded:,} excluded"
    return f"Evaluations: {document['evaluations']:,}, {document['failed_evaluations']:,} failed{left_out}"


def _ended(service: Remote, document: JsonObject) -> list[str]:
    if document["state"] == "done":
        lines = [document["verdict"].capitalize(), document["reason"], _counts(document)]
    elif document["state"] == "cancelled":
        lines = ["Cancelled: no verdict"]
    else:
        lines = ["Failed: no verdict", document["error"] or "no reason is recorded"]
    return [*lines, f"{service.address}/runs/{document['id']}"]
