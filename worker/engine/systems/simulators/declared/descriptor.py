"""Reads the descriptor of a program or an FMU that is a simulator: `simulator.yaml` in a folder of its own.

The operator lists folders of such folders in CLEARANCE_SIMULATORS; a campaign only names a simulator.
docs/your-own-simulator.md shows one.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationError, model_validator

from campaigns.asked.expected import expected
from campaigns.asked.reading import UnreadableError, parse
from campaigns.asked.values import Identifier, Strict
from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from worker.engine.systems.simulators.declared import fmu
from worker.engine.systems.simulators.declared.columns import Column
from worker.engine.systems.simulators.declared.described import BadDescriptor, Basics, Described, Finite, with_variables
from worker.engine.systems.simulators.declared.fmu_descriptor import FmuDescriptor
from worker.engine.systems.simulators.declared.fmu_model import Unusable
from worker.engine.systems.simulators.declared.folder import FILE, FOLDERS, folders
from worker.engine.systems.simulators.declared.function import Output
from worker.engine.systems.simulators.declared.scene import scene_of

NAMES = "give lower-case letters from a to z, digits and underscores, beginning with a letter"


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


class DescribedColumn(Strict):
    """A quantity over time that the program returns with a trace."""

    unit: str = ""
    symbol: str = ""
    text: str = ""


class Descriptor(Basics):
    """What `simulator.yaml` states of a program.

    command: program and arguments, run in the folder of the slot; `{folder}` is the descriptor's folder, `{python}` the
    interpreter that runs the worker, `{slot}` the number of the slot, and with protocol "files" `{parameters}` and
    `{results}` are the two files.
    protocol: "lines" for a process that reads one JSON object a line and writes one for each; "files" for a process for
    each evaluation, which reads parameters from one JSON file and writes results to another.
    ids: with "lines", whether each request has an `id`, which its answer must repeat.
    step: the parameter that is its step; it is not offered to campaigns, passed with its nominal value, and halved when
    cases are confirmed.
    trace: the quantities over time that the program returns on request, `time` [s] among them; with protocol "files"
    `{trace}` in the command is the file for them.
    """

    command: Annotated[tuple[str, ...], Field(min_length=1)]
    protocol: Literal["lines", "files"] = "lines"
    ids: Annotated[bool, Field(exclude_if=operator.not_, strict=True)] = False
    """Omitted from the description if false, so that commands of campaign files without it keep their digests."""
    parameters: Annotated[dict[Identifier, DescribedParameter], Field(min_length=1)]
    results: Annotated[dict[Identifier, DescribedResult], Field(min_length=1)]
    step: Identifier | None = None
    trace: Annotated[dict[Identifier, DescribedColumn], Field(max_length=64)] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ids_can_be_repeated(self) -> Self:
        if self.ids and self.protocol == "files":
            raise ValueError("ids is only for the protocol lines; with files each evaluation has its own process")
        return self

    @model_validator(mode="after")
    def _trace_can_be_asked_for(self) -> Self:
        placed = any("{trace}" in word for word in self.command)
        if not self.trace:
            if placed:
                raise ValueError("command: {trace} is the file of a trace; declare its columns under the key trace")
            return self
        time = self.trace.get("time")
        if time is None or len(self.trace) < 2:
            raise ValueError(
                f"trace: the column time and at least one other are expected, given {', '.join(self.trace)}"
            )
        if time.unit not in ("", "s"):
            raise ValueError(f"trace: time is in s, given the unit {time.unit}")
        if placed != (self.protocol == "files"):
            raise ValueError(
                "command: {trace}, the file for the trace, is missing"
                if self.protocol == "files"
                else "command: {trace} is only for the protocol files; with lines a trace is part of the answer"
            )
        return self

    @model_validator(mode="after")
    def _scene_can_be_drawn(self) -> Self:
        if self.scene is not None:
            scene_of(self.scene, {name: c.unit for name, c in self.trace.items()})
        return self

    @model_validator(mode="after")
    def _step_can_be_halved(self) -> Self:
        if self.step is None:
            return self
        step = self.parameters.get(self.step)
        if step is None:
            raise ValueError(f"step: {self.step} is not one of its parameters ({', '.join(self.parameters)})")
        half = step.nominal / 2
        if not half > 0.0 or half < step.low:
            limit = f"must be positive and within its limits, from {step.low:g}"
            raise ValueError(f"step: half of {self.step}, {half:g}, {limit}")
        if len(self.parameters) == 1:
            raise ValueError(f"step: {self.step} is the only parameter; a campaign needs another one")
        return self


@dataclass(frozen=True)
class DescribedProgram(Described):
    """The descriptor of a program."""

    descriptor: Descriptor

    @property
    def columns(self) -> dict[str, Column]:
        return {name: Column(c.unit, c.text, c.symbol) for name, c in self.descriptor.trace.items()}

    @property
    def entry(self) -> SimulatorEntry:
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
                if name != d.step
            ],
            results=result_entries(d.results),
            step=d.step,
        )


def result_entries(results: Mapping[str, DescribedResult] | Mapping[str, Output]) -> list[ResultEntry]:
    """How a campaign and the pages see the results of a program or a function."""
    return [
        ResultEntry(name=n, title=r.title or n, quantity=r.quantity or n, unit=r.unit, worse=r.worse, text=r.text)
        for n, r in results.items()
    ]


LARGEST = 200_000
"""The largest descriptor that is read [bytes]."""

LONGEST = 400
"""Characters of a message of the reader of YAML."""


def read(folder: Path) -> Described:
    """The descriptor of a folder; raises BadDescriptor."""
    file = folder / FILE
    try:
        if file.stat().st_size > LARGEST:
            raise BadDescriptor(f"{file}: a descriptor has at most {LARGEST:,} bytes")
        text = file.read_text(encoding="utf-8")
        document = with_variables(parse(text), text)
        if isinstance(document, dict) and "fmu" in document:
            return fmu.read(folder.resolve(), document)
        return DescribedProgram(folder.resolve(), Descriptor.model_validate(document))
    except RecursionError:
        raise BadDescriptor(f"{file}: nested too deeply") from None
    except UnreadableError as error:
        where = f"{error.problem.field}: " if error.problem.field else ""
        raise BadDescriptor(f"{file}: {where}{error.problem.message[:LONGEST]}") from None
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"] if part != "[key]") or "the file"
        message = expected(first, FmuDescriptor if error.title == FmuDescriptor.__name__ else Descriptor)
        if first.get("ctx", {}).get("pattern") == "^[a-z][a-z0-9_]*$":
            message = f"{first['input']!r:.60} is not a name: {NAMES}"
        raise BadDescriptor(f"{file}: {place}: {message}") from None
    except Unusable as error:
        raise BadDescriptor(f"{file}: {error}") from None
    except BadDescriptor:
        raise
    except (OSError, ValueError) as error:
        raise BadDescriptor(f"{file}: {' '.join(str(error).split())[:LONGEST]}") from None


def listed() -> Iterator[Described | BadDescriptor]:
    """The descriptors in the operator's folders, and what is wrong with those that cannot be used."""
    for folder in folders():
        for inner in sorted(p.parent for p in folder.glob(f"*/{FILE}")):
            try:
                yield read(inner)
            except BadDescriptor as error:
                yield error


def unusable() -> list[str]:
    """What is wrong with the operator's folders and the descriptors in them, a sentence each."""
    found = [f"{FOLDERS} names {folder}, which is not a folder" for folder in folders() if not folder.is_dir()]
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
