"""The digests of folders: what identifies the files of a simulator, here and on every node that evaluates it."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from campaigns.identity.identity import unread
from worker.engine.systems.simulators.declared.below import files_below
from worker.engine.systems.simulators.declared.external import READS
from worker.engine.systems.simulators.declared.reached import Reached, reached

FOLDERS = "CLEARANCE_SIMULATORS"
"""The environment variable that lists the operator's folders."""
FILE = "simulator.yaml"
"""The descriptor in the folder of a simulator."""


def folders() -> list[Path]:
    """The folders that the operator lists."""
    return [Path(folder) for folder in os.environ.get(FOLDERS, "").split(os.pathsep) if folder]


def watched() -> Iterator[Path]:
    """The files of the operator's folders that decide which simulators there are, and their digests."""
    for folder in folders():
        with contextlib.suppress(OSError):  # a folder that has just been removed
            for file in sorted(folder.glob("*.py")):
                yield from files_of_place({"file": str(file)})
            for descriptor in sorted(folder.glob(f"*/{FILE}")):
                yield from files_below(descriptor.parent)


def digest_of(folder: Path) -> str:
    """SHA-256 over all files below a folder, by relative path and content."""
    return digest_of_named((str(path.relative_to(folder)), path) for path in files_below(folder))


def digest_of_named(named: Iterable[tuple[str, Path]], begun: str = "") -> str:
    """SHA-256 over a text and these files, by name and content."""
    sink = hashlib.sha256(begun.encode())
    for name, path in named:
        content = path.read_bytes()
        sink.update(f"{name}\0{len(content)}\0".encode())
        sink.update(content)
    return sink.hexdigest()


def digest_of_place(place: Mapping[str, str]) -> str:
    """SHA-256 over the file of a function and the other Python files of its folder, or over its package, and over what
    it imports and reads besides; it identifies nothing (`unread`) if not all of that can be read."""
    folder, besides = _folder_of(place), reached_from(place)
    if folder is not None:
        digest = digest_of_named(_python_files(folder, ""))
    else:
        digest = hashlib.sha256(b"".join(path.read_bytes() for path in _within(place))).hexdigest()
    others = _outside(place, besides)
    if others or besides.packages:
        digest = digest_of_named(others.items(), "".join(f"{name};" for name in (digest, *sorted(besides.packages))))
    return unread(digest) if besides.unknown else digest


def files_of_place(place: Mapping[str, str]) -> list[Path]:
    """The files that the digest of a place covers."""
    return [*_within(place), *_outside(place, reached_from(place)).values()]


def reached_from(place: Mapping[str, str]) -> Reached:
    """What the file of a function imports and reads."""
    reads = tuple(place[READS].splitlines()) if READS in place else ()
    if "file" in place:
        file = Path(place["file"])
        return reached(file, search=(str(file.parent),), reads=reads)
    folder, inner = _folder_of(place), place["module"].split(".")[1:]
    if folder is None:
        return reached(_within(place)[0], reads=reads) if _within(place) else Reached()
    path = folder.joinpath(*inner, "__init__.py")
    if not path.is_file():
        path = folder.joinpath(*inner).with_suffix(".py")
    package = place["module"] if path.name == "__init__.py" else place["module"].rpartition(".")[0]
    return reached(path, package, reads=reads)


def _within(place: Mapping[str, str]) -> list[Path]:
    """The Python files of the folder of a place, or its only file."""
    folder = _folder_of(place)
    if folder is not None:
        return [path for _, path in _python_files(folder, "")]
    spec = importlib.util.find_spec(place["module"].partition(".")[0])
    return [Path(spec.origin)] if spec and spec.origin else []


def _outside(place: Mapping[str, str], besides: Reached) -> dict[str, Path]:
    """The files that it imports from elsewhere, by module, and its data files."""
    inside = {path.resolve() for path in _within(place)}
    imported = {name: path for name, path in sorted(besides.files.items()) if path.resolve() not in inside}
    return imported | {f"data/{name}": path for name, path in sorted(besides.data.items())}


def _folder_of(place: Mapping[str, str]) -> Path | None:
    """The folder of a file, or of a package; None for a module that is a single file."""
    if "file" in place:
        return Path(place["file"]).parent
    spec = importlib.util.find_spec(place["module"].partition(".")[0])
    if spec is not None and spec.submodule_search_locations:
        return Path(next(iter(spec.submodule_search_locations)))
    return None


def _python_files(folder: Path, prefix: str) -> Iterator[tuple[str, Path]]:
    """The Python files of a folder, and of the packages in it, by relative name."""
    for path in sorted(folder.iterdir()):
        if path.suffix == ".py" and path.is_file():
            yield f"{prefix}{path.name}", path
        elif (path / "__init__.py").is_file():
            yield from _python_files(path, f"{prefix}{path.name}/")
