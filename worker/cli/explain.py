"""`clearance explain FILE`: prints the closed loop of a campaign as it is simulated, as plain Python."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def explain(
    file: Annotated[Path, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")],
) -> None:
    """Print the closed loop that is simulated: the order of the components' calls, and their inputs."""
    from worker.cli import WrongInputError
    from worker.cli._campaign import read_campaign
    from worker.kernels.text.names import UnnamedError
    from worker.opening.opened import closed_loop
    from worker.systems.base import CampaignUnusable

    try:
        loop = closed_loop(read_campaign(file), compiled=False).loop
    except (CampaignUnusable, UnnamedError) as error:
        raise WrongInputError(str(error)) from None
    typer.echo(loop.text, nl=False)
    typer.echo(f"The file to set breakpoints in: {loop.module.__file__}", err=True)
