"""Reads the descriptor of a program that is a simulator: `simulator.yaml` in a folder of its own.

The operator lists folders of such folders in CLEARANCE_SIMULATORS; a campaign only names a simulator. Start reading at
`Descriptor`; docs/your-own-simulator.md shows one.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

import yaml
from pydantic import Field, ValidationError, field_validator, model_validator

from campaigns.asked.values import Identifier, Strict
from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from worker.catalogue.folder import digest_of

FILE = "simulator.yaml"
FOLDERS = "CLEARANCE_SIMULATORS"

Finite = Annotated[float, Field(allow_inf_nan=False)]


class DescribedParameter(Strict):
    """A number that the program takes."""

    unit: str = ""
    nominal: Finite
    low: Finite
    high: Finite
    text: str = ""
    symbol: str = ""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.low <= self.nominal <= self.high:
            raise ValueError(f"nominal {self.nominal:g} must be within [low {self.low:g}, high {self.high:g}]")
        return self


class DescribedResult(Strict):
    """A number that the program returns; `worse` is the end that a search looks for."""

    title: str = ""
    quantity: str = ""
    unit: str = ""
    worse: Literal["low", "high"] = "low"
    text: str = ""


class Descriptor(Strict):
    """What `simulator.yaml` states.

    command: program and arguments, run in the folder of the slot; `{folder}` is the descriptor's folder, `{slot}` the
    number of the slot, and with protocol "files" `{parameters}` and `{results}` are the two files.
    protocol: "lines" for a process that reads one JSON object a line and writes one for each; "files" for a process for
    each evaluation, which reads parameters from one JSON file and writes results to another.
    timeout: of an evaluation [s]; start: until the process must have started [s]; memory: address space of each of its
    processes [bytes]; recycle: evaluations until the process is replaced; slots: processes side by side, 0 for one a
    core.
    """

    name: Identifier
    title: str = ""
    text: str = ""
    command: Annotated[tuple[str, ...], Field(min_length=1)]
    protocol: Literal["lines", "files"] = "lines"
    parameters: Annotated[dict[Identifier, DescribedParameter], Field(min_length=1)]
    results: Annotated[dict[Identifier, DescribedResult], Field(min_length=1)]
    timeout: Annotated[float, Field(gt=0, le=86_400, allow_inf_nan=False)] = 60.0
    start: Annotated[float, Field(gt=0, le=3_600, allow_inf_nan=False)] = 60.0
    memory: Annotated[int, Field(ge=0)] = 0
    recycle: Annotated[int, Field(ge=0)] = 0
    slots: Annotated[int, Field(ge=0, le=256)] = 0
    environment: dict[str, str] = Field(default_factory=dict)

    @field_validator("environment", mode="before")
    @classmethod
    def _texts(cls, given: object) -> object:
        return {str(k): str(v) for k, v in given.items()} if isinstance(given, dict) else given


@dataclass(frozen=True)
class Described:
    """A descriptor, and the folder that it was read from."""

    folder: Path
    descriptor: Descriptor

    @property
    def entry(self) -> SimulatorEntry:
        """How a campaign and the pages see it."""
        d = self.descriptor
        return SimulatorEntry(
            name=d.name,
            title=d.title or d.name,
            text=d.text,
            parameters=[
                ParameterEntry(
                    name=name, symbol=p.symbol, unit=p.unit, low=p.low, high=p.high, default=p.nominal, text=p.text
                )
                for name, p in d.parameters.items()
            ],
            results=[
                ResultEntry(
                    name=name,
                    title=r.title or name,
                    quantity=r.quantity or name,
                    unit=r.unit,
                    worse=r.worse,
                    text=r.text,
                )
                for name, r in d.results.items()
            ],
        )

    @property
    def digest(self) -> str:
        """SHA-256 over all files of its folder, by relative path and content."""
        return digest_of(self.folder)


class BadDescriptor(ValueError):
    """The file cannot be used; the message names it, the field, and what is expected."""


def read(folder: Path) -> Described:
    """The descriptor of a folder; raises BadDescriptor."""
    file = folder / FILE
    try:
        document = yaml.safe_load(file.read_text(encoding="utf-8"))
        return Described(folder.resolve(), Descriptor.model_validate(document))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise BadDescriptor(f"{file}: {' '.join(str(error).split())}") from None
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "the file"
        message = first["msg"].removeprefix("Value error, ")
        raise BadDescriptor(f"{file}: {place}: {message}") from None


def _folders() -> list[Path]:
    return [Path(given) for given in os.environ.get(FOLDERS, "").split(os.pathsep) if given]


def listed() -> Iterator[Described | BadDescriptor]:
    """The descriptors in the operator's folders, and what is wrong with those that cannot be used."""
    for folder in _folders():
        for inner in sorted(p.parent for p in folder.glob(f"*/{FILE}")):
            try:
                yield read(inner)
            except BadDescriptor as error:
                yield error


def unusable() -> list[str]:
    """What is wrong with the operator's folders and the descriptors in them, a sentence each."""
    found = [f"{FOLDERS} names {folder}, which is not a folder" for folder in _folders() if not folder.is_dir()]
    first: dict[str, Path] = {}
    for described in listed():
        if isinstance(described, BadDescriptor):
            found.append(str(described))
            continue
        name, folder = described.descriptor.name, described.folder
        if first.setdefault(name, folder) != folder:
            found.append(
                f"{folder / FILE}: name: {first[name]} already describes a simulator {name}; rename one of them"
            )
    return found
