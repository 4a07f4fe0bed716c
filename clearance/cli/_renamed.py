"""The note of a command that is called by its earlier name."""

from __future__ import annotations

import typer


def renamed(before: str, now: str) -> None:
    """Print it to the standard error, so that the output stays what a script reads."""
    typer.echo(
        f"Note: `clearance {before}` is now `clearance {now}`; the earlier name goes with the next version.", err=True
    )
