"""`clearance reproduce`: reproduces the published tables and figures, next to the published values.

The exit code is 0, or 1 if a row is outside the tolerance stated for the reconstruction, or if it or a figure could
not be computed. The comparison is in `worker.running.reproduce`.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clearance.cli import VIOLATED, WrongInputError, on_disk, refusing

if TYPE_CHECKING:
    from worker.running.reproduce.compare import Reproduction
    from worker.running.reproduce.ours import Flights


def reproduce(
    table: Annotated[
        list[str] | None,
        typer.Option(help="A table, figure, section or chapter, such as 5.3; repeat for more. Default: all."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print only JSON.")] = False,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print Markdown.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder for tables and the data behind the figures.", file_okay=False)
    ] = None,
    steps: Annotated[
        bool,
        typer.Option(
            "--steps",
            help="Instead, check the time step of each campaign: simulate random points again with half of it.",
        ),
    ] = False,
    threads: Annotated[int, typer.Option(help="Simulation threads; 0 means one per core.", min=0, max=1024)] = 0,
) -> None:
    """Compute the published tables again and state for each row whether it agrees."""
    if steps:
        if table or as_markdown or out is not None or threads:
            raise WrongInputError("--steps checks all campaigns: leave --table, --markdown, --out and --threads out")
        _steps(as_json)
        return
    from worker.running.reproduce.ours import Flights

    flights = Flights(threads=threads or None)
    try:
        made = _reproduced(table or [], flights, quiet=as_json or as_markdown)
        made, files, missing = (made, [], []) if out is None else _written(out, made, flights)
    finally:
        flights.close()
    _show(made, as_json, as_markdown)
    if files and not (as_json or as_markdown):
        typer.echo(f"{len(files)} files in {out}")
    if missing or any(row.broken for row in made.rows):
        raise typer.Exit(VIOLATED)


def _reproduced(names: list[str], flights: Flights, quiet: bool) -> Reproduction:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

    from worker.running.reproduce.compare import chosen, reproduce

    with refusing(ValueError):
        chosen(names)
    console = Console(stderr=True, quiet=quiet)
    with Progress(BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console, transient=True) as bars:
        task = bars.add_task("rows")
        return reproduce(names, flights, lambda done, of: bars.update(task, completed=done, total=of))


def _written(folder: Path, made: Reproduction, flights: Flights) -> tuple[Reproduction, list[Path], list[str]]:
    """Write the figures; returns the reproduction with their time, the files, and a sentence for each missing
    figure."""
    from worker.running.reproduce import figures, render

    with on_disk(f"the folder {folder} cannot be written"):
        folder.mkdir(parents=True, exist_ok=True)
        began, compiled = time.perf_counter(), flights.compile_seconds
        files, missing = figures.write(folder, flights, {row.case for row in made.rows})
        compiling = flights.compile_seconds - compiled
        made = made.longer(time.perf_counter() - began - compiling, compiling)
        text = json.dumps(render.document(made), indent=2, allow_nan=False) + "\n"
        (folder / "tables.json").write_text(text, encoding="utf-8")
        (folder / "tables.md").write_text(render.markdown(made) + "\n", encoding="utf-8")
    for sentence in missing:
        typer.echo(sentence, err=True)
    return made, [*files, folder / "tables.json", folder / "tables.md"], missing


def _show(made: Reproduction, as_json: bool, as_markdown: bool) -> None:
    from worker.running.reproduce import render

    if as_json:
        typer.echo(json.dumps(render.document(made), indent=2, allow_nan=False))
    elif as_markdown:
        typer.echo(render.markdown(made))
    else:
        from rich.console import Console

        render.print_text(made, Console(width=None if sys.stdout.isatty() else 160))


def _steps(as_json: bool) -> None:
    from worker.running.reproduce.steps import of_library, sentence

    found = of_library()
    if as_json:
        typer.echo(json.dumps([vars(a) | {"ok": a.ok} for a in found], indent=2, allow_nan=False))
    else:
        for adequacy in found:
            typer.echo(sentence(adequacy))
    if not (found and all(a.ok for a in found)):
        raise typer.Exit(VIOLATED)
