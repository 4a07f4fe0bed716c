"""The source files of this installation: their content when loaded, and whether they have changed since.

Imported first in every process that simulates: it records the files before they are loaded, so that an edit while they
load shows, and what is loaded later is what was recorded (`module_files`). Packages that add components or methods by
entry points are covered too, and the operator's simulators, whose digests are published.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, version
from pathlib import Path

from worker.engine.components.own import folders, listed
from worker.engine.systems.simulators import ours as ours  # it records what slots load
from worker.engine.systems.simulators.declared.below import walked
from worker.engine.systems.simulators.declared.folder import watched
from worker.engine.systems.simulators.declared.unchanged import mark
from worker.running.runs.module_files import File, Recorded

FMPY = "fmpy"
PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "nlopt", "cma", "SALib", "clarabel", FMPY)
"""Third-party packages that can change a number, where a run uses them."""

GROUPS = ("clearance.components", "clearance.methods", "clearance.simulators")
OURS = ("campaigns", "worker")
OWN = "worker.engine.components.own"
"""The operator's own components: of each run, those that it uses are recorded apart from the code."""

_SUFFIXES = (".py", ".so", ".pyd")
_Stamp = tuple[tuple[str, int, int, int, int], ...]


@dataclass(frozen=True)
class Noted:
    """The files as they are at one moment."""

    files: dict[str, bytes]
    """The content by the module's name."""
    packages: dict[str, str]
    """Versions: those of `PACKAGES`, and of the packages that add components."""
    digest: str
    """Of both, byte by byte."""
    paths: tuple[str, ...]
    """Files and folders whose change may make another digest."""
    simulators: _Stamp
    """Of the files of the operator's simulators, which may be large: their content is not read here."""
    recorded: dict[str, File]
    """The files by the module's name."""


def note() -> Noted:
    """Read all files now."""
    simulators = _stamp(watched())
    recorded: dict[str, File] = {}
    paths: list[str] = []
    added = added_places()
    root = Path(__file__).parents[3]
    ours = [(name, root / name) for name in OURS]
    places = [*ours, *((name, place) for name, place, _ in added), *((OWN, folder) for folder in folders())]
    for name, place in places:
        found = _modules(name, place, paths) if name != OWN else _own(place, paths)
        for module, path in found:
            if module in recorded:
                continue  # of two own files of the same name the first one counts
            with suppress(FileNotFoundError):  # it was deleted since the folder was read
                before = mark(str(path))  # a later edit must not have it
                recorded[module] = File(str(path), before, path.read_bytes())
                paths.append(str(path))
    files = {module: file.content for module, file in recorded.items()}
    packages = {name: _version(name) for name in PACKAGES}
    packages |= {entry.dist.name: entry.dist.version for _, _, entry in added if entry.dist is not None}
    sink = hashlib.sha256(repr(sorted(packages.items())).encode())
    for module in sorted(files):
        sink.update(f"{module}:{hashlib.sha256(files[module]).hexdigest()};".encode())
    return Noted(files, packages, sink.hexdigest(), (*paths, *sys.path, *map(str, listed())), simulators, recorded)


def stale() -> bool:
    """Whether the files or package versions have changed since this process loaded them."""
    return present() != (LOADED.digest, LOADED.simulators)


def present() -> tuple[str, _Stamp]:
    """Digest of the files and stamp of those of simulators as they are now; files are read only if they may differ."""
    global _read
    simulators = _stamp(watched())
    paths, stamp, _ = _read
    if not stamp or _stamp(paths) != stamp:
        stamp = _stamp(paths)  # before the files are read: an edit meanwhile shows the next time
        noted = note()
        _read = noted.paths, stamp if noted.paths == paths else (), noted.digest
    return _read[2], simulators


def own(modules: Iterable[str]) -> dict[str, str]:
    """The digests of these modules of the operator, without documentation, by file: `my_robot.py`."""
    from worker.running.runs.meaning import meaning

    known = [name for name in modules if name in LOADED.files]
    return {f"{name.rpartition('.')[2]}.py": meaning(LOADED.files[name]).digest for name in known}


def own_modules() -> list[str]:
    """The modules of the operator as they were loaded."""
    return [name for name in LOADED.files if name.startswith(f"{OWN}.") and name != OWN]


def within(module: str, package: str) -> bool:
    """Whether a module is a package or one in it."""
    return module == package or module.startswith(f"{package}.")


def added_places() -> list[tuple[str, Path, EntryPoint]]:
    """The packages or single modules of others that entry points name, each with where it is."""
    found: dict[str, tuple[str, Path, EntryPoint]] = {}
    entries = entry_points()  # one look at all packages, 15 ms
    for entry in (entry for group in GROUPS for entry in entries.select(group=group)):
        parts = entry.module.split(".")
        if parts[0] in OURS:
            continue
        for count in range(1, len(parts) + 1):  # a namespace package is shared with others: go below it
            name = ".".join(parts[:count])
            with suppress(ImportError, ValueError):
                spec = importlib.util.find_spec(name)
                if spec is not None and spec.origin is not None:
                    place = Path(spec.origin).parent if spec.submodule_search_locations else Path(spec.origin)
                    found[name] = (name, place, entry)
                    break
    return list(found.values())


def _modules(name: str, place: Path, folders: list[str]) -> Iterator[tuple[str, Path]]:
    if place.is_file():
        yield name, place
        return
    for folder, files in walked(str(place)):
        folders.append(folder)
        below = ".".join([name, *Path(folder).relative_to(place).parts])
        for file in files:
            if file.endswith(_SUFFIXES):
                stem = file.partition(".")[0]
                yield below if stem == "__init__" else f"{below}.{stem}", Path(folder, file)


def _own(folder: Path, paths: list[str]) -> Iterator[tuple[str, Path]]:
    """The Python files of a folder of the operator, not those of folders in it."""
    paths.append(str(folder))
    for file in sorted(folder.glob("*.py")):
        yield f"{OWN}.{file.stem}", file


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _stamp(paths: Iterable[str | Path]) -> _Stamp:
    marks = ((str(path), mark(path)) for path in paths)
    return tuple((path, *found) for path, found in marks if found is not None)


def _drop_old_bytecode(paths: tuple[str, ...]) -> None:
    """Python takes bytecode for current when the source's size and second are the same: not after a quick edit."""
    for path in paths:
        if path.endswith(".py"):
            with suppress(OSError, NotImplementedError):
                compiled = importlib.util.cache_from_source(path)
                if os.stat(path).st_mtime_ns >= os.stat(compiled).st_mtime_ns:
                    os.unlink(compiled)


LOADED = note()
"""The files as they were before this process loaded them."""

_read: tuple[tuple[str, ...], _Stamp, str] = (LOADED.paths, (), "")
"""What `present` read last: paths, their stamp before they were read (empty: read them again), digest."""
_drop_old_bytecode(LOADED.paths)
sys.meta_path.insert(0, Recorded(LOADED.recorded))
