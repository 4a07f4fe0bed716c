"""`clearance explain FILE`: prints the simulated closed loop of a campaign as plain Python."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def explain(
    file: Annotated[Path, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")],
) -> None:
    """Print the closed loop that is simulated: the order of the components' calls, and their inputs."""
    from campaigns.claims.spans import words
    from clearance.cli import WrongInputError, refusing
    from clearance.cli._campaign import read_campaign
    from worker.engine.kernels.text.names import UnnamedError
    from worker.engine.systems.base import CampaignUnusable
    from worker.engine.systems.closed_loop.system import ClosedLoop
    from worker.evidence.scopes.terms import terms
    from worker.running.opening import opened

    with refusing(CampaignUnusable, UnnamedError):
        system = opened.system(read_campaign(file))
    if not isinstance(system, ClosedLoop):
        what = words(terms(system).scope.what)
        raise WrongInputError(f"{file}: {what} has no Python code to print; only a closed loop has")
    typer.echo(system.source.read_text(encoding="utf-8"), nl=False)
    typer.echo(f"The file to set breakpoints in: {system.source}", err=True)
