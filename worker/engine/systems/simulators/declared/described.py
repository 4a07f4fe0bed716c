"""What every described simulator has: the shared part of `simulator.yaml`, its folder, entry and digest."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import Field

from campaigns.asked.values import Identifier, Strict
from campaigns.catalogue import SimulatorEntry
from campaigns.results.scene import Scene
from worker.engine.systems.simulators.declared.below import files_below
from worker.engine.systems.simulators.declared.columns import Column
from worker.engine.systems.simulators.declared.folder import digest_of
from worker.engine.systems.simulators.declared.scene import scene_of

Finite = Annotated[float, Field(allow_inf_nan=False)]


class BadDescriptor(ValueError):
    """The file cannot be used; the message names it, the field, and what is expected."""


class Basics(Strict):
    """The part of a descriptor that does not depend on what is run.

    timeout: of an evaluation [s]; start: until the process must have started [s]; memory: address space of each of its
    processes [bytes]; recycle: evaluations until the process is replaced; slots: processes side by side, 0 for one a
    core; scene: which columns of its trace are positions of what, for the 3D view.
    """

    name: Identifier
    title: str = ""
    text: str = ""
    timeout: Annotated[float, Field(gt=0, le=86_400, allow_inf_nan=False)] = 60.0
    start: Annotated[float, Field(gt=0, le=3_600, allow_inf_nan=False)] = 60.0
    memory: Annotated[int, Field(ge=0)] = 0
    recycle: Annotated[int, Field(ge=0)] = 0
    slots: Annotated[int, Field(ge=0, le=256)] = 0
    environment: dict[str, str] = Field(default_factory=dict)
    scene: dict[str, Any] | None = None


def with_variables(document: Any, text: str, within: str = "") -> Any:
    """What was read from this text, with the variables of its environment as they are written there: 010, 1.10 and no
    are no numbers to a program. within: the key of the descriptor, if the text has more."""
    found: Any = document.get(within) if within and isinstance(document, dict) else document
    variables = found.get("environment") if isinstance(found, dict) else None
    if not isinstance(variables, dict) or all(isinstance(value, str) for value in variables.values()):
        return document
    written = _as_written(text)
    inner = found | {"environment": (written[within] if within else written)["environment"]}
    return document | {within: inner} if within else inner


def _as_written(text: str) -> Any:
    """A text that has been read as YAML, with every scalar as text; libyaml reads some texts that PyYAML does not."""
    try:
        return yaml.load(text, Loader=yaml.CBaseLoader)
    except yaml.YAMLError:
        return yaml.load(text, Loader=yaml.BaseLoader)


@dataclass(frozen=True)
class Described(ABC):
    """A simulator with a descriptor: a program (`worker.engine.systems.simulators.command`) or an FMU (`.fmus`).

    folder: that it was read from.
    """

    folder: Path
    descriptor: Basics

    @property
    @abstractmethod
    def entry(self) -> SimulatorEntry:
        """How a campaign and the pages see it."""

    @property
    @abstractmethod
    def columns(self) -> dict[str, Column]:
        """The columns of the trace that it returns on request; empty if it returns none."""

    @property
    def drawn(self) -> Scene | None:
        """What is drawn of a trace; raises ValueError."""
        stated = self.descriptor.scene
        return None if stated is None else scene_of(stated, {name: c.unit for name, c in self.columns.items()})

    @property
    def campaign_command(self) -> str:
        """The command line, if the campaign file gave it; empty for what the operator has installed."""
        return ""

    @property
    def covers(self) -> str:
        """What the digest is of, if that is not its folder."""
        return ""

    @property
    def covered(self) -> list[Path]:
        """The files that the digest covers."""
        return files_below(self.folder)

    @property
    def digest(self) -> str:
        """SHA-256 over all files of its folder, by relative path and content."""
        return digest_of(self.folder)
