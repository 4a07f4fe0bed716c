"""`clearance runs`: lists the runs of a service."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, opened

if TYPE_CHECKING:
    from clearance.client.answers import Run

Words = Annotated[str, typer.Argument(metavar="[WORDS]", help="Words in name, campaign, tags, owner or number.")]


def _filter(what: str) -> typer.models.OptionInfo:
    option: typer.models.OptionInfo = typer.Option(help=f"{what}; alternatives may be repeated.", show_default=False)
    return option


def runs(
    words: Words = "",
    label: Annotated[list[str] | None, _filter("Label, KEY=VALUE, of every key that is given")] = None,
    state: Annotated[list[str] | None, _filter("queued, running, cancelling, cancelled, failed or done")] = None,
    verdict: Annotated[list[str] | None, _filter("cleared, violated or inconclusive")] = None,
    campaign: Annotated[list[str] | None, _filter("Name of a campaign")] = None,
    owner: Annotated[list[str] | None, _filter("User or token that submitted it")] = None,
    tag: Annotated[list[str] | None, _filter("Tag")] = None,
    limit: Annotated[
        int, typer.Option(help="Maximum number of runs: pinned ones first, then the newest.", min=1, max=10**9)
    ] = 20,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON array, as the API returns its items.")] = False,
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """List the runs of a service: number, verdict or state, lowest margin found, start, code, name, labels.

    Another run speaks against a verdict that is contradicted; `clearance show` names it.
    """
    import itertools
    import json

    from clearance.cli._following import aligned

    several = {"label": label, "state": state, "verdict": verdict, "campaign": campaign, "owner": owner, "tag": tag}
    filters: dict[str, Any] = {name: tuple(values or ()) for name, values in several.items()}
    with opened(service, token_file, patience) as client:
        found = client.runs(words, **filters)
        listed = list(itertools.islice(found, limit))
    if as_json:
        typer.echo(json.dumps([run.document for run in listed], indent=2))
    elif not listed:
        typer.echo("No runs", err=True)
    else:
        typer.echo("\n".join(aligned([_row(run) for run in listed])))


def _row(run: Run) -> list[str]:
    from campaigns.claims.numbers import signed
    from campaigns.versions import SHORT
    from clearance.cli._following import ended_as, moment, plain

    margin = "" if run.margin is None else f"{signed(run.margin)} {run.unit}".rstrip()
    unread = run.document.get("unidentified")
    labels = " ".join(f"{key}={value}" for key, value in run.labels.items())
    return [
        run.id,
        ended_as(run),
        margin,
        moment(run.created),
        (run.document.get("code") or "")[:SHORT] or ("not identified" if unread else ""),
        plain(run.name),
        labels,
    ]
