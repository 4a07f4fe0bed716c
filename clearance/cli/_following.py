"""The output of `clearance submit` and `clearance follow`: progress, the verdict, the files of a run."""

from __future__ import annotations

import json
import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.runs import RunState
from clearance.cli import INCONCLUSIVE, WrongInputError, on_disk, refusing
from clearance.cli._ended import Case, EndedRun, Source, changes, read, sureness
from clearance.cli._exports import LIST, refuse_to_replace
from clearance.cli._exports import save as save_into
from clearance.local.citation import lines as citing

if TYPE_CHECKING:
    from datetime import datetime

    from clearance.cli._launch import Launch
    from clearance.client import Client
    from clearance.client.answers import Finding, Run, RunDetail

FILES = ("campaign.yaml", "run.json", "evaluations.csv", "findings.csv", "report.html")
"""Files of a run that are saved."""
PICTURE = "worst-case.svg"
"""The picture of the worst case, where the summary is that of a step of GitHub."""
Out = Annotated[
    Path | None,
    typer.Option(
        help=f"Folder for the run's files: {', '.join(FILES)}. They replace only what such a command saved there.",
        file_okay=False,
    ),
]
CONTINUES = "{run} continues in the background; `clearance follow {run}` follows it again"
GRACE = 5.0
"""How long to try to cancel a run when this command is ended [s]."""
AsJson = Annotated[bool, typer.Option("--json", help="Print only the run's JSON, as the API returns it.")]
_GITHUB = "GITHUB_STEP_SUMMARY"


def follow_to_the_end(
    service: Client,
    run: Run,
    out: Path | None,
    as_json: bool,
    launch: Launch,
    reused: str | None = None,
    cancel: bool = False,
    source: Source | None = None,
) -> int:
    """Show a run until it has ended, save its files; returns the exit code.

    run: an answer of the service, so that no other run is followed that has its number after a restore; launch: the
    files of a CI job; reused: why the run is an earlier one; cancel: an interrupt cancels the run; source:
    the campaign file.
    """
    from clearance.client import UnreachableError

    try:
        found = _shown(service, run, quiet=as_json)
    except KeyboardInterrupt:
        typer.echo(_cancelled(service, run) if cancel else CONTINUES.format(run=run.id), err=True)
        raise
    except UnreachableError:
        typer.echo(CONTINUES.format(run=run.id), err=True)
        raise
    ended = as_ended(service, found, reused)
    # Before the files, which the service may be unable to deliver.
    typer.echo(json.dumps(found.document, indent=2) if as_json else "\n".join(_ended(service, found, ended)))
    lost: WrongInputError | None = None
    try:
        if launch.wanted:
            launch.write(_complete(service, found, ended, launch, out, source))
    except WrongInputError as error:
        lost = error
    if out is not None:
        save(service, found, out, FILES)
        typer.echo(f"Files in {out}", err=True)
    if lost is not None:
        raise lost
    return ended.code


def save(service: Client, run: str | Run, out: Path, names: tuple[str, ...]) -> list[Path]:
    """Download files of a run into a folder; `WrongInputError` if it cannot be written or a name is impossible."""
    with refusing(ValueError):
        return [out / file.name for file in save_into(out, partial(service.export, run, files=names))]


def saves(name: str) -> bool:
    """Whether a file of this name may be saved in `--out`."""
    return name in (*FILES, PICTURE, LIST)


def refuse_out(out: Path | None, summary: Path | None, source: Path | None = None) -> None:
    """Raises `WrongInputError` if a file that is to be saved in `out` would replace another one. source: the campaign
    file."""
    refuse_to_replace(out, (*FILES, PICTURE) if _pictured_apart(summary) else FILES, source)


def _cancelled(service: Client, run: str | Run) -> str:
    """Cancel the run, before the CI service kills this command; returns what has happened."""
    from clearance.client import ClearanceError, UnreachableError
    from clearance.client.calls import name_of

    name = name_of(run)
    service.session.patience = min(service.session.patience or GRACE, GRACE)
    try:
        service.cancel(run)
    except UnreachableError as error:
        return f"whether {name} was cancelled is not known: {error}"
    except ClearanceError as error:
        return f"{name} could not be cancelled: {error}"
    return f"{name} was cancelled, because this command was ended"


def as_ended(service: Client, found: RunDetail, reused: str | None = None) -> EndedRun:
    """The run as its files state it; an earlier version of the service has no labels and no baseline."""
    from campaigns.identity.identity import Identity
    from campaigns.results import Verdict
    from campaigns.results.verdict import by_earlier_rules

    document, compared = found.document, found.baseline
    criterion = (document.get("campaign") or {}).get("criterion") or {}
    stated = document["summary"] if found.state == RunState.DONE else None
    verdict = Verdict.model_validate(stated) if stated else None
    rules = by_earlier_rules(found.id) if verdict is not None and verdict.earlier_rules else None
    baseline = None if compared is None else compared.sentence
    code = document.get("identity")  # an earlier version of the service sends none
    extends = citing({"run": found.continues}) if found.continues else []
    return EndedRun(
        run=found.id,
        identity=None if code is None else Identity.model_validate(code),
        campaign=found.campaign_name,
        state=found.state,
        verdict=verdict,
        error=found.error or superseded(found),
        link=service.link(found),
        replay=f"clearance replay --service {shlex.quote(service.address)} {found.id}",
        labels=found.labels,
        notes=tuple(filter(None, [document.get("against"), rules, reused, *extends, baseline, removal(found)])),
        against=document.get("against") or "",
        against_runs=tuple(document.get("against_runs") or ()),
        seconds=worked(found),
        compared=compared is None or compared.run is not None,
        quantity=found.quantity,
        unit=found.unit,
        threshold=found.threshold,
        lowest=found.worst_cost,
        requirements=tuple(one["id"] for one in criterion.get("requirements", [])),
    )


def worked(found: RunDetail) -> float:
    """The working time of its stages [s]; from start to end, a retried run would count how long it lay failed."""
    return sum(stage.seconds for stage in found.stages)


def plain(text: str) -> str:
    """The text without what a terminal would obey: names and reasons may contain any character."""
    from campaigns.claims.legible import legible

    return legible(text, "\n")


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """The rows of a table as lines."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def superseded(found: Run) -> str:
    """Why a run of a group was cancelled; empty if it was not."""
    if not found.superseded_by:
        return ""
    return f"{found.superseded_by} superseded it in the group {found.group}"


def removal(found: Run) -> str:
    """That a run was removed from the lists, by whom, when and why; empty if it was not."""
    if found.removed is None:
        return ""
    reason = (found.removed_reason or "no reason is recorded").rstrip(".")
    return f"Removed from the lists by {found.removed_by or 'unknown'}, {moment(found.removed)}: {reason}."


def moment(at: datetime) -> str:
    """A time of a service, in UTC."""
    return at.strftime("%Y-%m-%dT%H:%M:%SZ")


def case(found: Finding) -> Case:
    """A finding by the value to state for it; a service of an earlier version answers without one."""
    stated = found.cost if found.granted is None else found.granted
    likely = "" if found.likelihood is None or found.likelihood.density is None else found.likelihood.text
    drawn = None if found.validation is None else found.validation.realisation
    confirmed = found.violates is not False
    return Case(found.label, stated, found.margin, found.parameters, found.cost, likely, drawn, confirmed)


def _complete(
    service: Client, found: RunDetail, ended: EndedRun, launch: Launch, out: Path | None, source: Source | None
) -> EndedRun:
    """The run with what only its files state: findings, the campaign's text, the picture of the worst case."""
    cases = tuple(case(f) for f in service.findings(found))
    if launch.sarif is not None and source is None:
        address = f"{service.address}/api/v1/runs/{ended.run}/campaign.yaml"
        source = Source(address, service.campaign_text(found))
    picture = "" if launch.summary is None or not cases else _picture(service, found, launch.summary, out)
    return replace(ended, findings=cases, source=source, picture=picture)


def _picture(service: Client, run: RunDetail, summary: Path, out: Path | None) -> str:
    """Download the picture of the worst case next to the summary; its name, empty if the run has none.

    GitHub shows no picture that is next to the summary of a step, so that there it is among the files of `--out`.
    """
    from clearance.client import RefusedError

    apart, name = _pictured_apart(summary), f"{summary.stem}-{run.id}.svg"
    try:
        if not apart:
            with on_disk(f"{summary.parent / name} cannot be written"):
                service.picture(run, summary.parent / name)
        elif out is not None:
            save_into(out, lambda folder: service.picture(run, folder / PICTURE))
    except RefusedError as error:
        typer.echo(f"No picture in the summary: {error}", err=True)
        return ""
    return "" if apart else name


def _pictured_apart(summary: Path | None) -> bool:
    """Whether the picture of the worst case cannot be next to the summary."""
    there = os.environ.get(_GITHUB)
    return summary is not None and bool(there) and Path(there or "").resolve() == summary.resolve()


def _shown(service: Client, run: Run, quiet: bool) -> RunDetail:
    """The run once it has ended; until then a line for every stage, in place where that is a terminal."""
    live, before = not quiet and sys.stderr.isatty(), ""

    def show(found: Run) -> None:
        nonlocal before
        line = _line(found, figures=live)
        if not quiet and line != before:
            typer.echo(f"\r\033[K{line}" if live else line, err=True, nl=not live)
            before = line

    found = service.wait(run, on_change=show)
    if live and before:
        typer.echo("\r\033[K", err=True, nl=False)
    return found


def _line(found: Run, figures: bool) -> str:
    stage = found.stage
    if found.state != RunState.RUNNING or stage is None:
        return f"{found.id} {found.state}" + (f": {plain(found.waits)}" if found.waits else "")
    name = stage.kind if stage.method is None else f"{stage.kind}: {stage.method}"
    if not figures:
        return f"{found.id} {name}"
    best = "" if stage.best is None else f", best {read(stage.best, found.threshold)} {found.unit}"
    # Excluded samples are drawn again; a service of an earlier version does not report what is left.
    whole = max(stage.planned, stage.evaluations + (stage.left or 0))
    of = f" of {'about ' if whole > stage.planned else ''}{whole:,}"
    of = of if stage.left is not None or stage.evaluations <= stage.planned else ""
    return f"{found.id} {name}, {stage.evaluations:,}{of} evaluations{best}"


def ended_as(found: Run) -> str:
    """The verdict in large, or the state without one."""
    from campaigns.results.verdict import headline

    return headline(found.verdict, found, found.policy, found.against) if found.verdict else found.state


def counts(found: Run) -> str:
    """How many evaluations there are; a service of an earlier version does not report the excluded ones."""
    excluded = found.document.get("excluded_evaluations")
    left_out = "" if excluded is None else f", {excluded:,} excluded"
    return f"Evaluations: {found.evaluations:,}, {found.failed_evaluations:,} failed{left_out}"


def _ended(service: Client, found: RunDetail, ended: EndedRun) -> list[str]:
    if found.state == RunState.DONE:
        lines = [ended_as(found).capitalize(), found.reason or "", counts(found)]
    elif found.state == RunState.CANCELLED:
        lines = ["Cancelled: no verdict", *filter(None, [superseded(found) or plain(found.error or "")])]
    else:
        lines = ["Failed: no verdict", plain(found.error or "no reason is recorded")]
    lines += filter(None, [ended.unconfirmed])
    return [*lines, *map(plain, ended.notes), *verdict_lines(ended), service.link(found)]


def verdict_lines(ended: EndedRun) -> list[str]:
    """How sure the search is, the changes since the baseline, and what decides the exit code in place of the verdict;
    empty without a verdict."""
    if ended.verdict is None:
        return []
    decided = ended.contradicted and ended.code == INCONCLUSIVE
    why = [f"The exit code is {INCONCLUSIVE}: other runs speak against the verdict."] if decided else []
    return list(map(plain, [*sureness(ended.verdict), *changes(ended.verdict), *why]))
