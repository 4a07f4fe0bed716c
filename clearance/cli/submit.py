"""`clearance submit FILE`: submits a campaign to a service and follows it to its verdict, for a CI job.

The exit code is that of `clearance run`.
"""

from __future__ import annotations

from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from clearance.cli import WrongInputError
from clearance.cli import _launch as launch
from clearance.cli._following import AsJson, Out, follow_to_the_end, refuse_out, saves
from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, opened


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
    baseline: launch.Baseline = None,
    reuse: Annotated[
        bool,
        typer.Option("--reuse", help="Reuse an earlier verdict of the same campaign and code, if there is one."),
    ] = False,
    sample_seed: launch.DrawnSampleSeed = None,
    junit: launch.Junit = None,
    summary: launch.Summary = None,
    sarif: launch.Sarif = None,
    group: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", show_default=False,
            help="Concurrency group, such as project/branch: cancels your runs of the same group that have not ended; "
            "an administrator's command cancels those of all owners.",
        ),
    ] = None,
    cancel_on_exit: Annotated[
        bool, typer.Option("--cancel-on-exit", help="Cancel the run when this command is ended (SIGTERM, Ctrl-C).")
    ] = False,
) -> None:  # fmt: skip
    """Submit a campaign to a service and wait for its verdict, which is the exit code."""
    from campaigns.asked.load import load_text, read_text
    from campaigns.checked.expected import at_most
    from campaigns.stages.plan import most
    from clearance.cli._campaign import found
    from clearance.cli._ended import Source
    from clearance.cli._exports import refuse_to_replace
    from clearance.cli._out import writable
    from clearance.cli._sweep import TABLE, parsed
    from clearance.cli._sweep import sweep as launched
    from clearance.local.interrupt import terminated

    options = launch.Launch.read(label, baseline, junit, summary, sarif, out, saves)
    _check_options(options, sweep, wait, reuse or sample_seed is not None, cancel_on_exit, group)
    if not (wait or sweep) and (as_json or out is not None):
        raise WrongInputError("--json and --out need the end of the run: leave --no-wait out")
    writable(out)
    if sweep:
        parsed(sweep)  # before anything is sent
    path = found(file)
    if sweep:
        refuse_to_replace(out, (TABLE,), path)
    else:
        refuse_out(out, summary, path)
    text = read_text(path)
    campaign = load_text(text, str(file))
    document = campaign.document()
    called, tags, compared = name or None, tag or None, options.baseline or None
    with opened(service, token_file, patience, str(file)) as client:
        if sweep:
            if wait:
                typer.echo(f"{at_most(campaign, most(campaign))} for each run.", err=True)
            made = partial(client.sweep, document, name=called, tags=tags, labels=options.labels, priority=priority)
            raise typer.Exit(launched(client, made, sweep, wait, out, as_json))
        with terminated() if cancel_on_exit else nullcontext():
            try:
                queued = client.submit(
                    document, text=text, name=called, tags=tags, labels=options.labels, priority=priority,
                    baseline=compared, reuse=reuse, sample_seed=sample_seed, group=group,
                )  # fmt: skip
            except KeyboardInterrupt:
                typer.echo(
                    "the submission was interrupted, so a run may be queued: `clearance runs` lists them", err=True
                )
                raise
            reused = queued.reused
            compared_to = "" if queued.baseline is None else queued.baseline.sentence
            for note in filter(None, [] if wait else [reused, compared_to]):
                typer.echo(note, err=True)
            if queued.superseded:
                typer.echo(f"{', '.join(queued.superseded)} of the group {queued.group} superseded", err=True)
            if not wait:
                typer.echo(queued.id)  # on standard output, alone on its line, for programs
                return
            typer.echo(f"{queued.id} is at {client.link(queued)}", err=True)
            if not reused:
                typer.echo(f"{at_most(campaign, queued.planned)}.", err=True)
            source, cancel = Source(str(path), text), cancel_on_exit and not reused
            raise typer.Exit(follow_to_the_end(client, queued, out, as_json, options, reused, cancel, source))


def _check_options(
    options: launch.Launch, sweep: str, wait: bool, reuse: bool, cancel: bool, group: str | None
) -> None:
    """Raises `WrongInputError` for options that do not belong together."""
    if group is not None and not group.strip():  # an unset variable of a CI job would supersede nothing
        raise WrongInputError("--group is empty: give a name such as project/branch, or leave it out")
    if sweep and (options.baseline or options.wanted or reuse or cancel or group):
        raise WrongInputError(
            "--sweep cannot be combined with --baseline, --junit, --summary, --sarif, --reuse, --sample-seed, --group "
            "or --cancel-on-exit"
        )
    if not wait and (options.wanted or cancel):
        raise WrongInputError("--junit, --summary, --sarif and --cancel-on-exit need the verdict: leave --no-wait out")
