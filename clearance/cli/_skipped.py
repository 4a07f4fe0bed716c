"""Reports the simulators of the operator's folders that cannot be used, and why."""

from __future__ import annotations

import typer


def report_unusable() -> None:
    """Report the simulators that were skipped: one of them may be the one that the campaign names."""
    from worker.engine.systems.simulators.declared.descriptor import unusable
    from worker.running.catalogue.files import unusable_files

    for problem in [*unusable(), *unusable_files()]:
        typer.echo(f"a simulator is skipped: {problem}", err=True)
