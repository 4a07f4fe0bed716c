"""`clearance submit FILE`: submits a campaign to a service and follows it to its verdict, for a CI job.

The exit code is that of `clearance run`.
"""

from __future__ import annotations

import uuid
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from campaigns.documents import JsonObject
from worker.cli import WrongInputError
from worker.cli import _launch as launch
from worker.cli._following import PATIENCE, SERVICE, AsJson, Out, Patience, Service, Token


def submit(
    file: Annotated[Path, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")],
    service: Service = SERVICE,
    token_file: Token = "",
    name: Annotated[str, typer.Option(help="Name of the run; default: the campaign's name.")] = "",
    tag: Annotated[
        list[str] | None, typer.Option(help="Tag, may be repeated; default: the campaign's tags.", show_default=False)
    ] = None,
    priority: Annotated[int, typer.Option(help="Runs with a higher priority start first.", min=-10, max=10)] = 0,
    sweep: Annotated[
        str,
        typer.Option(
            metavar="PATH=V1,V2,...", show_default=False,
            help="A run for each value of a fixed parameter; the exit code is that of the worst of them.",
        ),
    ] = "",
    wait: Annotated[bool, typer.Option(help="Wait for the verdict; otherwise print only the run's number.")] = True,
    out: Out = None,
    as_json: AsJson = False,
    patience: Patience = PATIENCE,
    label: launch.Label = None,
    baseline: launch.Baseline = "",
    reuse: Annotated[
        bool,
        typer.Option("--reuse", help="Take an earlier verdict on the same campaign by the same code, if there is one."),
    ] = False,
    junit: launch.Junit = None,
    summary: launch.Summary = None,
    cancel_on_exit: Annotated[
        bool, typer.Option("--cancel-on-exit", help="Cancel the run when this command is ended (SIGTERM, Ctrl-C).")
    ] = False,
) -> None:  # fmt: skip
    """Submit a campaign to a service and wait for its verdict, which is the exit code."""
    from campaigns.asked.load import load_text, read_text
    from worker.cli._campaign import found
    from worker.cli._following import follow_to_the_end, token_of
    from worker.cli._interrupt import terminated
    from worker.cli._out import writable
    from worker.cli._remote import Remote
    from worker.cli._sweep import parsed
    from worker.cli._sweep import sweep as launched

    writable(out)
    given = launch.Launch.read(label, baseline, junit, summary)
    _asked_right(given, sweep, wait, reuse, cancel_on_exit)
    if sweep:
        parsed(sweep)  # before anything is sent
    text = read_text(found(file))
    body: JsonObject = {"campaign": load_text(text, str(file)).document(), "text": text, "priority": priority}
    body |= {"name": name} if name else {}
    body |= {"tags": tag} if tag else {}
    body |= {"labels": given.labels} if given.labels else {}
    body |= {"baseline": given.baseline} if given.baseline else {}
    body |= {"reuse": True} if reuse else {}
    with Remote(service, token_of(token_file), patience) as remote:
        if sweep:
            raise typer.Exit(launched(remote, body, str(file), sweep, wait, out, as_json))
        with terminated() if cancel_on_exit else nullcontext():
            queued = remote.submit(body, str(file), str(uuid.uuid4()))
            run, reused = queued["id"], queued.get("reused")
            if not wait:
                compared = queued.get("baseline") or {}
                for note in filter(None, [reused, compared.get("sentence")]):
                    typer.echo(note, err=True)
                typer.echo(run)
                return
            typer.echo(f"{run} is at {remote.address}/runs/{run}", err=True)
            raise typer.Exit(follow_to_the_end(remote, run, out, as_json, given, reused, cancel_on_exit and not reused))


def _asked_right(given: launch.Launch, sweep: str, wait: bool, reuse: bool, cancel: bool) -> None:
    """Raises `WrongInputError` for options that do not belong together."""
    if sweep and (given.baseline or given.junit or given.summary or reuse or cancel):
        raise WrongInputError("--sweep takes none of --baseline, --junit, --summary, --reuse and --cancel-on-exit")
    if not wait and (given.junit or given.summary or cancel):
        raise WrongInputError(
            "--no-wait does not wait for the verdict: --junit, --summary and --cancel-on-exit need it"
        )
