"""`clearance validate FILE...`: validates campaign files against this installation, or against a service."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clearance.cli import WRONG_INPUT, WrongInputError, _explain
from clearance.cli import _code as code
from clearance.cli._service import PATIENCE, Patience, Token, opened

if TYPE_CHECKING:
    from campaigns import Campaign

HELP = "Campaigns as YAML or JSON, or the names of campaigns in the library."
Service = Annotated[
    str,
    typer.Option(metavar="URL", show_default=False, help="Check against the components of this service instead."),
]


def validate(
    files: Annotated[list[Path] | None, typer.Argument(metavar="FILE...", help=HELP)] = None,
    normal: Annotated[
        bool, typer.Option("--normal", help="Print the campaign with every default written out.")
    ] = False,
    allow_code: code.AllowCode = False,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a campaign instead.")] = False,
    service: Service = "",
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """Check campaign files: print their problems, or their digest and the stages of a run."""
    from campaigns import Campaign, CampaignError

    if schema:
        if files or normal or allow_code or service:
            raise WrongInputError("--schema is given alone: it prints the schema of every campaign")
        typer.echo(json.dumps(Campaign.model_json_schema(), indent=2))
        return
    if not files:
        raise WrongInputError("give a campaign file, or --schema")
    if service and (normal or allow_code):
        raise WrongInputError(
            "--service cannot be combined with --normal or --allow-code: a service runs no code of a campaign"
        )
    wrong = 0
    for file in files:
        try:
            if service:
                _by_service(file, service, token_file, patience)
            else:
                _here(file, normal, allow_code)
        except CampaignError as error:
            if len(files) == 1:
                raise
            _explain(error)
            wrong += 1
    if wrong:
        typer.echo(f"{wrong} of {len(files)} campaigns cannot be used", err=True)
        raise typer.Exit(WRONG_INPUT)


def _here(file: Path, normal: bool, allow_code: bool) -> None:
    from campaigns import CampaignError, check
    from campaigns.checked import prediction
    from campaigns.checked.foreseen import foreseen
    from worker.running.catalogue.installed import catalogue
    from worker.running.runs.reaches import excesses

    campaign, known = code.read(file, allow_code), catalogue()
    problems = check(campaign, known) or list(excesses(campaign))
    if problems:
        if campaign.simulator is not None:
            code.report_unusable()
        raise CampaignError(str(file), problems)
    if normal:
        typer.echo(json.dumps(campaign.document(), indent=2))
        return
    _print_usable(file, campaign, "here")
    best = prediction.predicted(campaign, known)
    if best is not None:
        typer.echo(best.statement)
    for each in foreseen(campaign, known):
        typer.echo(f"Warning: {each.statement}", err=True)


def _by_service(file: Path, service: str, token_file: str, patience: float) -> None:
    """The service's own answer: its components, methods and simulators are those that would run the campaign."""
    from campaigns import CampaignError, Problem
    from clearance.cli._campaign import read_campaign

    campaign = read_campaign(file)
    with opened(service, token_file, patience, str(file)) as client:
        found = client.check(campaign.document())
    if not found.ok:
        raise CampaignError(str(file), [Problem(p.field, p.given, p.message) for p in found.problems])
    if found.digest != campaign.digest:
        raise WrongInputError(
            f"{service} reads {file} as another campaign (sha256 {(found.digest or '')[:16]}, here "
            f"{campaign.digest[:16]}): it is of another version; use the command line of its version"
        )
    _print_usable(file, campaign, f"by {service}")
    bound = found.predicted_bound
    if bound is not None:
        typer.echo(bound.statement)
    # A service of an earlier version knows the bound alone.
    of_bound = [bound.warning] if bound is not None and bound.warning is not None else []
    for statement in [each.statement for each in found.foreseen] or of_bound:
        typer.echo(f"Warning: {statement}", err=True)


def _print_usable(file: Path, campaign: Campaign, where: str) -> None:
    from campaigns.checked.expected import called, computing, fewer
    from campaigns.stages.plan import bound, most

    typer.echo(f"{file}: {campaign.name} can be run {where}. Digest {campaign.digest[:16]}")
    named = "uncertain parameter" if len(campaign.uncertain) == 1 else "uncertain parameters"
    limit, computes = most(campaign), computing(campaign)
    typer.echo(f"{len(campaign.uncertain)} {named}, at most {limit:,} evaluations{called(campaign, limit)}:")
    for stage in bound(campaign):
        # Certify draws excluded samples again; traces and confirmations are made again without being stored.
        again = f", and {stage.again:,} that are not stored" if stage.again else ""
        shorter = fewer(campaign, stage.kind)
        when = ", which computes without them" if stage.kind in computes else f"; {shorter.when}" if shorter else ""
        typer.echo(f"  {stage.kind}{f' by {stage.method}' if stage.method else ''}: {stage.stored:,}{again}{when}")
