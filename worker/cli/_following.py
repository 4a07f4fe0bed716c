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
from worker.cli import UnreachableError, WrongInputError
from worker.cli._ended import EndedRun, changes, write_files

if TYPE_CHECKING:
    from worker.cli._launch import Launch
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
CONTINUES = "{run} continues in the background; `clearance follow {run}` follows it again"
GRACE = 5.0
"""How long to try to cancel a run when this command is ended [s]."""
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


def follow_to_the_end(
    service: Remote,
    run: str,
    out: Path | None,
    as_json: bool,
    given: Launch | None = None,
    reused: str | None = None,
    cancel: bool = False,
) -> int:
    """Show a run until it has ended, save its files; returns the exit code.

    given: the files of a CI job; reused: why the run is an earlier one; cancel: an interrupt cancels the run.
    """
    try:
        document = _shown(service, run, quiet=as_json)
    except KeyboardInterrupt:
        typer.echo(_cancelled(service, run) if cancel else CONTINUES.format(run=run), err=True)
        raise
    except UnreachableError:
        typer.echo(CONTINUES.format(run=run), err=True)
        raise
    ended = _as_ended(service, document, reused)
    # Before the files, which the service may be unable to deliver.
    typer.echo(json.dumps(document, indent=2) if as_json else "\n".join(_ended(service, document, ended)))
    if given is not None:
        write_files(ended, given)
    if out is not None:
        for name, path in FILES.items():
            service.save(path.format(run=run), out / name)
        typer.echo(f"Files in {out}", err=True)
    return ended.code


def _cancelled(service: Remote, run: str) -> str:
    """Cancel the run, before the CI service kills this command; returns what has happened."""
    service.patience = min(service.patience, GRACE)
    try:
        service.cancel(run)
    except (UnreachableError, WrongInputError) as error:
        return f"{run} could not be cancelled: {error}"
    return f"{run} was cancelled, because this command was ended"


def _as_ended(service: Remote, document: JsonObject, reused: str | None) -> EndedRun:
    """The run as its files state it; a service of an earlier version knows no labels and no baseline."""
    from campaigns.results import Verdict

    run, compared = document["id"], document.get("baseline")
    criterion = (document.get("campaign") or {}).get("criterion") or {}
    started, finished = document["started"], document["finished"]
    done = document["state"] == "done"
    return EndedRun(
        run=run,
        campaign=document["campaign_name"],
        state=document["state"],
        verdict=Verdict.model_validate(document["summary"]) if done and document["summary"] else None,
        error=document["error"] or "",
        link=f"{service.address}/runs/{run}",
        replay=f"clearance replay {run}",
        labels=document.get("labels") or {},
        notes=tuple(filter(None, [reused, compared and compared["sentence"]])),
        seconds=0.0 if started is None or finished is None else finished - started,
        compared=not compared or compared["run"] is not None,
        criterion=criterion.get("result") or criterion.get("component") or "",
        requirements=tuple(one["id"] for one in criterion.get("requirements", [])),
    )


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


def _ended(service: Remote, document: JsonObject, ended: EndedRun) -> list[str]:
    if document["state"] == "done":
        lines = [document["verdict"].capitalize(), document["reason"], _counts(document)]
    elif document["state"] == "cancelled":
        lines = ["Cancelled: no verdict"]
    else:
        lines = ["Failed: no verdict", document["error"] or "no reason is recorded"]
    lines += ended.notes
    if ended.verdict is not None:
        lines += changes(ended.verdict)
    return [*lines, f"{service.address}/runs/{document['id']}"]
