"""A program whose descriptor a campaign file contains, as `clearance run --allow-code` permits; the service never does.

The mapping `simulator` of such a file has the keys of a descriptor, and `repeats` and `retries` of a campaign. It is
taken out of the file and installed for this process, so that everything after that sees a simulator with a name.
"""

from __future__ import annotations

import json
import os
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os.path import isfile
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from campaigns.asked.expected import expected
from campaigns.asked.problem import CampaignError, Problem, shown
from worker.engine.systems.simulators.declared.descriptor import DescribedProgram, Descriptor
from worker.engine.systems.simulators.declared.folder import digest_of_named
from worker.running.catalogue.installed import catalogue, simulators

NAME = "inline"
"""Of a simulator whose campaign file gives it none."""
OWN = ("repeats", "retries")
"""Keys that are the campaign's, not the descriptor's."""
WORDS = 'a list of words is expected, such as ["{python}", "{folder}/drop.py"]; {folder} is the folder of this file'


@dataclass(frozen=True)
class InlineProgram(DescribedProgram):
    """A program as a campaign file describes it; its folder is that of the file."""

    file: str
    """The campaign file."""

    @property
    def campaign_command(self) -> str:
        return shlex.join(self.descriptor.command)

    @property
    def covered(self) -> list[Path]:
        """The files that the command names and this user may read, also as in `--config={folder}/drop.json`."""
        words = [word.replace("{folder}", str(self.folder)) for word in self.descriptor.command]
        named = dict.fromkeys(part for word in words for part in (word, word.partition("=")[2]))
        return [Path(name) for name in named if name.startswith("/") and isfile(name) and os.access(name, os.R_OK)]

    @property
    def digest(self) -> str:
        """SHA-256 over the descriptor and the files that its command names: its folder may contain anything."""
        document = json.dumps(self.descriptor.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))
        return digest_of_named(((f"\0{path.name}", path) for path in self.covered), document)

    @property
    def covers(self) -> str:
        names = [path.name for path in self.covered]
        of_files = f" and of {', '.join(names)}" if names else ""
        return f"of its description in the campaign file{of_files}"


def taken_out(document: Any, file: Path) -> tuple[Any, InlineProgram | None]:
    """A campaign's document without the command in it, which names the simulator instead, and the program.

    None for a campaign that gives no command. Raises `CampaignError` if the description cannot be used.
    """
    simulator = document.get("simulator") if isinstance(document, Mapping) else None
    if not isinstance(simulator, Mapping) or "command" not in simulator:
        return document, None
    described = {"name": NAME} | {key: value for key, value in simulator.items() if key not in OWN}
    descriptor = descriptor_of(described, str(file))
    named = {"name": descriptor.name} | {key: simulator[key] for key in OWN if key in simulator}
    return {**document, "simulator": named}, InlineProgram(file.resolve().parent, descriptor, str(file))


def descriptor_of(described: Any, source: str) -> Descriptor:
    """The descriptor that a campaign file gave, or simulator.yaml of its results; raises `CampaignError`."""
    try:
        return Descriptor.model_validate(described)
    except ValidationError as error:
        raise CampaignError(source, list(_problems(error))) from None


def install(program: InlineProgram) -> None:
    """Add it to the simulators of this process, in place of an earlier one of a campaign file."""
    name = program.descriptor.name
    known = simulators().get(name)
    if known is not None and not isinstance(known, InlineProgram):
        text = "this installation has a simulator of that name: give the command of this file another one, or remove it"
        raise CampaignError(program.file, [Problem("simulator.name", name, text)])
    simulators()[name] = program
    catalogue.cache_clear()


def _problems(error: ValidationError) -> Iterator[Problem]:
    for found in error.errors(include_url=False):
        at = [str(part) for part in found["loc"]]
        message = expected(found, Descriptor)
        if at[:1] == ["command"] and found["type"] in ("tuple_type", "string_type"):
            message = WORDS
        elif found["type"] == "extra_forbidden":
            message = "not a key of a simulator's descriptor; remove it or correct its spelling"
        value = "" if found["type"] == "missing" or not at else shown(found.get("input"))
        yield Problem(".".join(["simulator", *at]), value, message)
