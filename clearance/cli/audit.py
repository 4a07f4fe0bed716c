"""`clearance audit RUN`: checks with an independent program whether a run's verdict follows from its stored data.

The exit code is 0 if it follows, 1 if it does not or is not known to, 3 if there is nothing to audit. The program is
`worker.evidence.audit`. `clearance audit verify` and `head` are earlier names of `clearance trail`, for one version.
"""

from __future__ import annotations

import json
import secrets
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from campaigns.refusals import RefusalCode
from clearance.cli import VIOLATED, WrongInputError, replay
from clearance.cli._code import AllowCode, for_replay
from clearance.cli._service import Token
from clearance.cli._where import DATA, Data, Database, Service, StoredRun, stored_in
from clearance.cli.trail import print_head, verify_trail

if TYPE_CHECKING:
    from clearance.cli.replay import Again
    from worker.evidence.audit.judge import Item

WORDS = {True: "agree", False: "disagree", None: "not auditable"}


def renamed(before: str, now: str) -> None:
    """Print the note of a command that is called by its earlier name, so that the output stays what a script reads."""
    typer.echo(
        f"Note: `clearance {before}` is now `clearance {now}`; the next version removes the earlier name.", err=True
    )


class _RunFirst(TyperGroup):
    """A group whose command `run` may be left out: `clearance audit R-0001`."""

    usual = "run"

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if args and args[0] not in self.commands:
            args = [self.usual, *args]
        elif args and args[0] in ("verify", "head"):
            renamed(f"audit {args[0]}", f"trail {args[0]}")
        return super().parse_args(ctx, args)


class _Unnamed(TyperCommand):
    """The command `run` of the group, whose usage and errors name the group alone: `clearance audit`."""

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        if parent is not None:  # the group's name as that of this command, below the parent of the group
            info_name, extra["obj"], extra["default_map"] = parent.info_name, parent.obj, parent.default_map
            parent = parent.parent
        return super().make_context(info_name, args, parent, **extra)


app = typer.Typer(
    cls=_RunFirst,
    help="RUN: recompute the verdict of a run independently.",
    no_args_is_help=True,
    subcommand_metavar="RUN",
)
app.command("verify", hidden=True)(verify_trail)
app.command("head", hidden=True)(print_head)


@app.command("run", cls=_Unnamed)
def audit(
    ctx: typer.Context,
    run: Annotated[str, typer.Argument(help="The folder of a `run --out`, or the id of a stored run, such as R-0001.")],
    rows: Annotated[
        int | None,
        typer.Option(
            "--replay",
            min=0,
            metavar="N",
            help="Also evaluate N stored evaluations, drawn at random each time, the nominal case and all findings "
            "again, and as many draws of a sample of which only a part is stored, and compare them as `clearance "
            "replay` does.",
            show_default=False,
        ),
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Also print the items that agree.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print only one JSON object.")] = False,
    data: Data = DATA,
    database: Database = "",
    service: Service = "",
    token_file: Token = "",
    allow_code: AllowCode = False,
) -> None:
    """Recompute a run's verdict from its stored evaluations with an independent program, and compare.

    Counts, lowest costs, margins, the agreement of the methods, the sample's bounds, the validation, every check and
    the numbers of the sentence are recomputed. Nothing is simulated without --replay: the costs are those stored.
    """
    from worker.evidence.audit import judge
    from worker.evidence.audit.record import of_database, of_folder
    from worker.running.runs.audited import audited

    if allow_code and rows is None:
        raise WrongInputError("--allow-code is for --replay: nothing else is executed", RefusalCode.OPTIONS)
    with stored_in(ctx, run, data, database, service, token_file) as stored:
        items = audited(stored.load(of_folder, of_database))
        follows, sentence = judge.closing(items)
        again = None if rows is None else _again(run, stored, rows, allow_code)
    if as_json:
        listed = [item._asdict() | {"agrees": item.agrees} for item in items]
        answer = {"run": run, "follows": follows, "sentence": sentence, "items": listed}
        typer.echo(json.dumps(answer if again is None else answer | {"replay": again.document()}, indent=2))
    else:
        _print(items, every)
        typer.echo(f"{sentence[0].upper()}{sentence[1:]}.")
        for line in () if again is None else (*again.lines(all_of_them=False), again.closing()):
            typer.echo(line)
    raise typer.Exit(0 if follows and (again is None or again.agrees) else VIOLATED)


def _again(run: str, place: StoredRun, rows: int, allow_code: bool) -> Again:
    """The nominal case, all findings, so many evaluations and blocks that have as many, which whoever wrote the record
    could not foresee."""
    from worker.running.runs.block_replay import having

    recorded = place.load(replay.of_folder, replay.of_database)
    stored = [f"{at}:{k}" for at, columns in recorded.evaluations.items() for k in range(len(columns.status))]
    drawn = secrets.SystemRandom().sample(stored[1:], min(rows, len(stored) - 1))
    names = [*stored[:1], *(finding.label for finding in recorded.findings), *drawn]
    problem = replay.opened_here(run, recorded, for_replay(run, allow_code))
    return replay.evaluated_again(run, recorded, problem, names, having(recorded, rows))


def _print(items: list[Item], every: bool) -> None:
    import sys

    from rich.console import Console
    from rich.table import Table

    from campaigns.claims.numbers import count

    table = Table("Item", "Given", "Recomputed", "")
    for item in items:
        if every or not item.agrees:
            table.add_row(item.name, _shown(item.given), _shown(item.recomputed), WORDS[item.agrees])
    if table.rows:
        Console(width=None if sys.stdout.isatty() else 160, markup=False).print(table)
    numbers = ", ".join(f"{count(sum(item.agrees is flag for item in items))} {word}" for flag, word in WORDS.items())
    typer.echo(f"{count(len(items))} items: {numbers}{'' if every else ' (--all prints those that agree)'}.")


def _shown(value: Any) -> str:
    return repr(value) if isinstance(value, float) else "none" if value is None else str(value)
