"""`clearance validate FILE`: validates a campaign file against the components of this installation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from worker.cli import _code as code


def validate(
    file: Annotated[Path, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")],
    normal: Annotated[
        bool, typer.Option("--normal", help="Print the campaign with every default written out.")
    ] = False,
    allow_code: code.AllowCode = False,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a campaign instead.")] = False,
) -> None:
    """Check a campaign file: print its problems, or its digest and the stages of a run."""
    import json

    from campaigns import Campaign, CampaignError, check
    from campaigns.stages.plan import plan
    from worker.catalogue.installed import catalogue

    if schema:
        typer.echo(json.dumps(Campaign.model_json_schema(), indent=2))
        return
    campaign = code.read(file, allow_code)
    problems = check(campaign, catalogue())
    if problems:
        raise CampaignError(str(file), problems)
    if normal:
        typer.echo(json.dumps(campaign.document(), indent=2))
        return
    stages = plan(campaign)
    typer.echo(f"{campaign.name}: can be run here. Digest {campaign.digest[:16]}")
    typer.echo(f"{len(campaign.uncertain)} uncertain parameters, at most {sum(s.planned for s in stages)} evaluations:")
    for stage in stages:
        typer.echo(f"  {stage.kind}{f' by {stage.method}' if stage.method else ''}: {stage.planned}")
