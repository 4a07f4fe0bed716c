"""The option --allow-code: the campaign file may contain the command of a simulator."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError

if TYPE_CHECKING:
    from campaigns import Campaign
    from worker.running.catalogue.inline import InlineProgram

AllowCode: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--allow-code",
        help="Permit `simulator: {command: ...}` in the campaign file, also to extend or replay its run. It runs "
        "any program as you: only for files that you trust. The service never does.",
    ),
]
GIVEN, FOLDER = "command_given", "folder"
"""Keys of result.json: where the campaign file was that gave the command."""
HOW = "; for a file that you trust, --allow-code permits its command"


def read(file: Path, allowed: bool) -> Campaign:
    """The campaign of a file or of the library; a command in it is installed for this process if that is allowed.

    Raises `CampaignError`.
    """
    from campaigns import CampaignError
    from campaigns.asked.load import load_document, load_file, read_text
    from campaigns.asked.reading import UnreadableError, parse
    from clearance.cli._campaign import found
    from worker.engine.systems.simulators.declared.described import with_variables
    from worker.running.catalogue.inline import install, taken_out

    path = found(file)
    if not allowed:
        try:
            return load_file(path)
        except CampaignError as error:
            # What else is wrong with a simulator that is a command follows from this.
            code = [replace(p, message=p.message + HOW) for p in error.problems if p.field == "simulator.command"]
            raise CampaignError(error.source, code or error.problems) from None
    try:
        text = read_text(path)
        document = with_variables(parse(text), text, "simulator")
    except UnreadableError as error:
        raise CampaignError(str(path), [error.problem]) from None
    document, program = taken_out(document, path)
    campaign = load_document(document, str(path))
    if program is not None:
        install(program)
    return campaign


def report_unusable() -> None:
    """Report the simulators that were skipped: one of them may be the one that the campaign names."""
    from worker.running.catalogue.files import unusable_simulators

    for problem in unusable_simulators():
        typer.echo(f"a simulator is skipped: {problem}", err=True)


def of_results(run: str, allowed: bool, done: str = "extended") -> None:
    """Install the command of a run that is to be extended or replayed, if its campaign file gave one and it is allowed.

    run: the folder of its `--out`, or the id of a stored run, which never has one. Raises `WrongInputError`.
    """
    from clearance.cli._where import stored_run
    from clearance.local.results import versions_of
    from worker.running.catalogue.inline import install

    if stored_run(run) is not None:
        if allowed:
            raise WrongInputError(
                "--allow-code is for a campaign file or the folder of its results; a stored run has no command: leave "
                "--allow-code out",
                RefusalCode.OPTIONS,
            )
        return
    command = versions_of(Path(run)).command
    if not command:
        return
    if not allowed:
        raise WrongInputError(
            f"{run} cannot be {done}: its campaign file gave the command of the simulator, {command}; for a run that "
            "you trust, --allow-code permits it",
            RefusalCode.CODE_NOT_PERMITTED,
        )
    try:
        install(_described(Path(run)))
    except (OSError, ValueError) as error:
        raise WrongInputError(f"{run} cannot be {done}: {error}") from None


def for_replay(run: str, allowed: bool) -> str:
    """Check a run as `of_results` does before its cases are evaluated again. Returns what to add if this installation
    has not its simulator: that its campaign file gave the command, which was not permitted; empty if none did."""
    from clearance.local.results import versions_of

    if allowed:
        of_results(run, allowed, "replayed")
        return ""
    command = versions_of(Path(run)).command
    text = f". Its campaign file gave the command, {command}; for a run that you trust, --allow-code permits it"
    return text if command else ""


def _described(folder: Path) -> InlineProgram:
    """The program that simulator.yaml in a folder of results describes; raises ValueError and OSError."""
    from campaigns.asked.reading import parse
    from worker.engine.systems.simulators.declared.described import with_variables
    from worker.engine.systems.simulators.declared.folder import FILE
    from worker.running.catalogue.inline import InlineProgram, descriptor_of

    file, source = folder / FILE, _stated(folder / "result.json")
    if not source:
        raise ValueError("its result.json does not state where its campaign file was; run the campaign again")
    if not Path(source[FOLDER]).is_dir():
        raise ValueError(f"the folder of its campaign file, {source[FOLDER]}, no longer exists; run the campaign again")
    try:
        text = file.read_text(encoding="utf-8")
        document = with_variables(parse(text), text)
    except (OSError, ValueError) as error:
        raise ValueError(f"{file.name} in it cannot be read: {' '.join(str(error).split())}") from None
    return InlineProgram(Path(source[FOLDER]), descriptor_of(document, str(file)), source["file"])


def _stated(file: Path) -> dict[str, str]:
    """What `stated` has written; empty if there is nothing that can be used."""
    try:
        source = json.loads(file.read_text(encoding="utf-8"))[GIVEN]
        return {name: str(Path(source[name])) for name in ("file", FOLDER)}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def stated(campaign: Campaign) -> dict[str, object]:
    """The folder of the campaign file that gave the command, for result.json; empty if none did."""
    known = _inline(campaign)
    return {} if known is None else {GIVEN: {"file": known.file, FOLDER: str(known.folder)}}


def _inline(campaign: Campaign) -> InlineProgram | None:
    from worker.running.catalogue.inline import InlineProgram
    from worker.running.catalogue.installed import simulators

    known = None if campaign.simulator is None else simulators().get(campaign.simulator.name)
    return known if isinstance(known, InlineProgram) else None


def program_of(campaign: Campaign) -> dict[str, object] | None:
    """The program that the campaign file gave, for a capsule; None if it gave none."""
    known = _inline(campaign)
    if known is None:
        return None
    descriptor = known.descriptor.model_dump(mode="json", exclude_unset=True)
    return {"descriptor": descriptor, "file": known.file, "folder": str(known.folder)}


def write_description(folder: Path, campaign: Campaign) -> None:
    """Write what the campaign file gave as simulator.yaml, with which it can be installed; nothing else is written."""
    import yaml

    from campaigns.asked.reading import Dumper
    from worker.engine.systems.simulators.declared.folder import FILE

    known = _inline(campaign)
    if known is None:
        return
    document = known.descriptor.model_dump(mode="json", exclude_unset=True)
    text = yaml.dump(document, Dumper=Dumper, sort_keys=False, allow_unicode=True, width=120)
    head = f"# From {known.file}, where {{folder}} was {known.folder}\n"
    (folder / FILE).write_text(head + text, encoding="utf-8")
