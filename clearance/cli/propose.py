"""`clearance propose`: search methods and budgets that fit the time one evaluation takes."""

from __future__ import annotations

from typing import Annotated

import typer


def propose(
    cost: Annotated[float, typer.Option("--cost", help="Time that one evaluation takes (seconds).")],
    parameters: Annotated[int, typer.Option("--parameters", help="Number of uncertain parameters.", min=1, max=64)],
    slots: Annotated[int, typer.Option("--slots", help="Evaluations that run side by side; at most 16 count.")] = 1,
    patience: Annotated[float, typer.Option("--patience", help="Time for all searches (seconds).")] = 3600.0,
    start: Annotated[float, typer.Option("--start", help="Time that the start of a process takes (seconds).")] = 0.0,
    recycle: Annotated[int, typer.Option("--recycle", help="Evaluations until a process is replaced.", min=0)] = 0,
) -> None:
    """Propose search methods and budgets for the time one evaluation takes; prints stages of a campaign file."""
    import yaml

    from campaigns.asked.proposal import Cost, proposed
    from campaigns.asked.reading import Dumper
    from campaigns.checked.expected import confirmation
    from clearance.cli import WrongInputError, refusing
    from worker.running.catalogue.installed import catalogue

    each = cost + (start / recycle if recycle else 0.0)
    with refusing(ValueError):
        found = proposed(catalogue().methods, each, parameters, slots, patience, start)
    if not found.searches:
        raise WrongInputError(f"{found.sentence}.")
    typer.echo(f"# {found.sentence}.")
    typer.echo("# The other stages take evaluations in addition; `clearance validate FILE` lists them.")
    typer.echo(f"# {confirmation(Cost(None, cost, slots, 0, start=start))}")
    search = [
        {"method": s.method, "evaluations": s.evaluations} | ({"options": s.options} if s.options else {})
        for s in found.searches
    ]
    typer.echo(yaml.dump({"stages": {"search": search}}, Dumper=Dumper, sort_keys=False), nl=False)
