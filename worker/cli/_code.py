"""The option --allow-code: the campaign file may contain the command of a simulator."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

if TYPE_CHECKING:
    from campaigns import Campaign

AllowCode: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--allow-code",
        help="Permit `simulator: {command: ...}` in the campaign file, which runs any program as you: only for files "
        "that you trust. The service never does.",
    ),
]
HOW = "; for a file that you trust, --allow-code permits its command"


def read(file: Path, allowed: bool) -> Campaign:
    """The campaign of a file or of the library; a command in it is installed for this process if that is allowed.

    Raises `CampaignError`.
    """
    from campaigns import CampaignError
    from campaigns.asked.load import load_document, load_file, read_text
    from campaigns.asked.reading import UnreadableError, parse
    from worker.catalogue.inline import install, taken_out
    from worker.cli._campaign import found

    path = found(file)
    if not allowed:
        try:
            return load_file(path)
        except CampaignError as error:
            code = [
                replace(p, message=p.message + HOW) if p.field == "simulator.command" else p for p in error.problems
            ]
            raise CampaignError(error.source, code) from None
    try:
        document = parse(read_text(path))
    except UnreadableError as error:
        raise CampaignError(str(path), [error.problem]) from None
    document, program = taken_out(document, path)
    campaign = load_document(document, str(path))
    if program is not None:
        install(program)
    return campaign


def write_description(folder: Path, campaign: Campaign) -> None:
    """Write what the campaign file gave as simulator.yaml, with which it can be installed; nothing else is written."""
    import yaml

    from worker.catalogue.described import FILE
    from worker.catalogue.inline import InlineProgram
    from worker.catalogue.installed import simulators
    from worker.catalogue.simulator import Program

    known = None if campaign.simulator is None else simulators().get(campaign.simulator.name)
    if not isinstance(known, Program) or not isinstance(known.described, InlineProgram):
        return
    document = known.described.descriptor.model_dump(mode="json", exclude_unset=True)
    text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=120)
    head = f"# From {known.described.file}, where {{folder}} was {known.described.folder}\n"
    (folder / FILE).write_text(head + text, encoding="utf-8")
