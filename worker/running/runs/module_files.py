"""Loads modules as their files were when this process recorded them, also after a release or an edit has replaced them.

Many modules are imported only when a stage needs them, minutes after the digest of a run's code was taken.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import CodeType, ModuleType
from typing import NamedTuple

from worker.engine.systems.simulators.declared.unchanged import Mark, mark


class File(NamedTuple):
    """The file of a module: what was in it, and what shows without reading it whether that may have changed."""

    path: str
    mark: Mark | None
    content: bytes


class Recorded:
    """Finds the modules of these files, by name; an entry of `sys.meta_path`."""

    def __init__(self, files: dict[str, File]) -> None:
        self.files = files

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module of a recorded file; None for all others, and for one that a user loads again (`target`).

        Raises ImportError for a file that is not Python and has changed.
        """
        file = self.files.get(name) if target is None else None
        if file is None:
            return None
        found = PathFinder.find_spec(name, path)
        if found is not None and found.origin is not None and _place(found.origin) != _place(file.path):
            return None  # another file of that name comes first
        if found is not None and not _same(found.origin, file.path):
            found = None  # a release has put another one in its place
        if not file.path.endswith(".py"):
            if found is None or (mark(file.path) != file.mark and _content(file.path) != file.content):
                raise ImportError(f"{file.path} has changed since this process started: start it again", name=name)
            return found
        folder = [str(Path(file.path).parent)] if Path(file.path).name == "__init__.py" else None
        return spec_from_file_location(
            name, file.path, loader=Loader(name, file), submodule_search_locations=folder
        )  # also of a file that is gone


class Loader(SourceFileLoader):
    """Loads the bytecode while the file is the recorded one, and what was recorded of it afterwards."""

    def __init__(self, name: str, file: File) -> None:
        super().__init__(name, file.path)
        self.file = file

    def get_code(self, fullname: str) -> CodeType | None:
        if mark(self.file.path) == self.file.mark is not None:
            code = super().get_code(fullname)
            if mark(self.file.path) == self.file.mark:
                return code
        code = self.source_to_code(self.file.content, self.file.path)
        assert isinstance(code, CodeType)
        return code


def _place(path: str) -> str:
    """The folder that has the module, or the package that it is."""
    file = Path(path)
    return os.path.realpath(file.parents[1] if file.stem == "__init__" else file.parent)


def _same(path: str | None, other: str) -> bool:
    return path == other or (path is not None and os.path.realpath(path) == os.path.realpath(other))


def _content(path: str) -> bytes | None:
    try:
        return Path(path).read_bytes()
    except OSError:
        return None
