"""Python files in the operator's folders whose functions are simulators, described without executing them here.

A file is loaded in a process of its own (`worker.running.catalogue.describing`), which prints what its decorated
functions declare: whatever it does (an error, a crash, an endless loop), it is reported and skipped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from campaigns.catalogue import ParameterEntry, SimulatorEntry
from campaigns.checked.check import selects_realisation
from campaigns.documents import JsonObject
from worker.engine.systems.simulators.declared.columns import Column
from worker.engine.systems.simulators.declared.described import Described
from worker.engine.systems.simulators.declared.descriptor import listed, result_entries, unusable
from worker.engine.systems.simulators.declared.folder import digest_of_place, folders
from worker.engine.systems.simulators.declared.function import (
    DESCRIBING,
    Declaration,
    Output,
    Parameter,
    Settings,
    in_units,
)
from worker.running.catalogue import describing
from worker.running.catalogue.alone import NoAnswer, answer_of

LONGEST = 60.0
"""Time for loading a file [s]."""


@dataclass(frozen=True)
class PythonFunction:
    """A decorated function as a simulator: its declaration, and where it is.

    place: its `name`, and its `file` or `module`; empty where only this process has it. call: the function, where this
    process has loaded it.
    """

    declaration: Declaration
    place: dict[str, str]
    call: Any = None

    @property
    def entry(self) -> SimulatorEntry:
        """How a campaign and the pages see it."""
        return entry_of(self.declaration)


class BadFile(ValueError):
    """A file that cannot be used; the message names it and what is expected."""


def entry_of(declaration: Declaration) -> SimulatorEntry:
    """The catalogue entry of a declaration."""
    d = in_units(declaration)
    return SimulatorEntry(
        name=d.name,
        title=d.title,
        text=d.text,
        parameters=[
            ParameterEntry(
                name=name, symbol=p.symbol, unit=p.unit, low=p.low, high=p.high, default=p.usual, text=p.text or name
            )
            for name, p in d.parameters.items()
        ],
        results=result_entries(d.results),
        seeds={name: value for name, value in d.constants.items() if selects_realisation(name)},
    )


def listed_files() -> Iterator[PythonFunction | BadFile]:
    """The functions that the files of the operator's folders declare, and what is wrong with those that cannot be used.

    A file is loaded only if its text contains `clearance`.
    """
    for folder in folders():
        for file in sorted(folder.glob("*.py")):
            try:
                yield from read_file(file)
            except BadFile as error:
                yield error


def unusable_simulators() -> list[str]:
    """What is wrong with the descriptors and Python files in the operator's folders, a sentence each."""
    found = unusable()
    first = {d.descriptor.name: str(d.folder) for d in listed() if isinstance(d, Described)}
    for function in listed_files():
        if isinstance(function, BadFile):
            found.append(str(function))
            continue
        name, file = function.declaration.name, function.place["file"]
        if name in first:
            found.append(f"{file}: {first[name]} already declares a simulator {name}; rename one of them")
        first.setdefault(name, file)
    return found


def read_file(file: Path) -> list[PythonFunction]:
    """The functions that a file declares; raises BadFile."""
    try:
        if b"clearance" not in file.read_bytes():
            return []
        digest = digest_of_place({"file": str(file)})
    except OSError as error:
        raise BadFile(f"{file}: {error.strerror}") from None
    found = _described(str(file.resolve()), digest)
    if isinstance(found, str):
        raise BadFile(f"{file}: {found}")
    return list(found)


@lru_cache(maxsize=256)
def _described(file: str, digest: str) -> tuple[PythonFunction, ...] | str:
    """What a file declares, as it was when its folder had this digest; or the reason why it cannot be used."""
    try:
        described = answer_of(describing.__name__, [file], describing.MARK, {DESCRIBING: "1"}, LONGEST)
    except NoAnswer as error:
        if not error.started:
            return f"it could not be loaded: {error}"
        if error.overdue:
            return f"loading it took {error}; put what runs long under `if __name__ == '__main__':`"
        return f"loading it {error}"
    if "error" in described:
        return str(described["error"])
    found = [PythonFunction(_restored(d["declaration"]), {"file": file, "name": d["name"]}) for d in described["found"]]
    for function in found:
        try:
            _ = function.declaration.drawn
        except ValueError as error:
            return f"{function.declaration.name}: {error}"
    return tuple(found)


def _restored(document: JsonObject) -> Declaration:
    return Declaration(
        document["name"],
        document["title"],
        document["text"],
        {name: Parameter(**p) for name, p in document["parameters"].items()},
        {name: Output(**r) for name, r in document["results"].items()},
        Settings(**document["settings"]),
        {name: Column(**c) for name, c in document["trace"].items()},
        document["scene"],
        constants=document["constants"],
    )
