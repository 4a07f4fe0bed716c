"""What a Python file imports and reads: files of one's own, declared data, packages by version, what is unreadable.

A file of one's own is neither of the standard library nor in a folder of installed packages; packages that are
installed to be edited are one's own. Nothing is executed. Start reading at `reached`.
"""

from __future__ import annotations

import contextlib
import importlib.machinery
import importlib.util
import os
import site
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from pathlib import Path

from worker.engine.systems.simulators.declared.below import files_below
from worker.engine.systems.simulators.declared.external import Use
from worker.engine.systems.simulators.declared.outside import Outside
from worker.engine.systems.simulators.declared.statements import Statements, statements

OURS = frozenset({"backend", "campaigns", "clearance", "worker"})
"""Identified by the code of a run."""
COMPILED = (*importlib.machinery.EXTENSION_SUFFIXES, ".pyc")


@dataclass
class Reached:
    """files: by module; data: the declared data files, by their name relative to the folder of the file; packages: the
    name and version of each distribution; unknown: a clause on the first thing that cannot be read, empty if there is
    none."""

    files: dict[str, Path] = field(default_factory=dict)
    data: dict[str, Path] = field(default_factory=dict)
    packages: set[str] = field(default_factory=set)
    unknown: str = ""


def reached(
    file: Path, package: str = "", search: tuple[str, ...] = (), reads: tuple[str, ...] = ()
) -> Reached:  # fmt: skip
    """What a file imports and reads. package: that it is a module of; search: folders that are searched first; reads:
    data files besides those that it declares."""
    path = list(dict.fromkeys([*search, *filter(None, sys.path)]))
    while True:
        walk = _Walk(path)
        walk.follow(file, package)
        wider = list(dict.fromkeys([*walk.front, *path, *walk.back]))
        if wider == path:
            walk.settle(file, reads)
            return walk.found
        path = wider  # a file changes the path, so that other modules may be found


class _Walk:
    """One walk over everything that is imported, with one search path."""

    def __init__(self, path: list[str]) -> None:
        self.path = path
        self.found = Reached()
        self.front: list[str] = []
        self.back: list[str] = []
        self._seen = set[str]()
        self._outside: list[tuple[Path, Use]] = []

    def follow(self, file: Path, package: str) -> None:
        waiting = [(file, package)]
        while waiting:
            waiting += self._file(*waiting.pop())

    def settle(self, file: Path, reads: tuple[str, ...]) -> None:
        """The data files that the first file declares, and what is read besides, as far as nothing else is unknown."""
        with contextlib.suppress(OSError):
            declared = statements(file).data + reads
            self.found.data, missing = data_files(declared, file.parent)
            self.found.unknown = self.found.unknown or missing
            for place, use in self._outside:
                if use.package not in {*OURS, *self.found.files} and not (declared and use.kind is Outside.FILES):
                    what = f"{use.kind.clause(use.name)}, line {use.line} of {place.name}"
                    self.found.unknown = self.found.unknown or what

    def _file(self, file: Path, package: str) -> Iterator[tuple[Path, str]]:
        try:
            read = statements(file)
        except OSError:
            read = Statements()  # reported when it is imported
        self.front += read.front
        self.back += read.back
        self._outside += [(file, use) for use in read.outside]
        self.found.unknown = self.found.unknown or read.unknown
        for name, level in read.names:
            try:
                absolute = importlib.util.resolve_name("." * level + name, package)
            except ImportError:
                continue  # outside of the package
            yield from self._module(absolute)

    def _module(self, name: str) -> Iterator[tuple[Path, str]]:
        """The files that an import of this name executes: the packages around it, and its own."""
        if name.partition(".")[0] in OURS or name.partition(".")[0] in sys.builtin_module_names:
            return
        path: list[str] | None = None
        parts = name.split(".")
        for count in range(1, len(parts) + 1):
            inner = ".".join(parts[:count])
            spec = _spec(inner, self.path if path is None else path, editable=path is None)
            if spec is None:
                return  # it is not a module, or cannot be imported
            if count == 1 and not self._own(inner, spec):
                return
            if inner not in self._seen:
                self._seen.add(inner)
                yield from self._added(inner, spec)
            path = list(spec.submodule_search_locations or [])

    def _own(self, name: str, spec: importlib.machinery.ModuleSpec) -> bool:
        """Whether a top module is one's own; a package that is installed is noted."""
        kind = where(spec.origin or next(iter(spec.submodule_search_locations or [""]), ""))
        if kind == "installed":
            self.found.packages.add(distribution(name))
        return kind == "own"

    def _added(self, name: str, spec: importlib.machinery.ModuleSpec) -> Iterator[tuple[Path, str]]:
        origin = spec.origin
        if origin is None or not spec.has_location:
            return  # a folder without a file of its own
        self.found.files[name] = Path(origin)
        if origin.endswith(COMPILED) or not os.path.isfile(origin):
            self.found.unknown = self.found.unknown or f"the compiled module {name}"
            return
        yield Path(origin), name if spec.submodule_search_locations is not None else name.rpartition(".")[0]


def data_files(declared: Iterable[str], folder: Path) -> tuple[dict[str, Path], str]:
    """The files of these paths, which may be folders, by their name relative to a folder, and a clause on the first one
    that is missing."""
    found: dict[str, Path] = {}
    for text in declared:
        path = folder / text
        files = files_below(path) if path.is_dir() else [path]
        if not files or not os.access(files[0], os.R_OK):
            return found, f"the missing data file {text}"
        found |= {os.path.relpath(p, folder): p for p in files}
    return found, ""


_distributions = cache(packages_distributions)


def distribution(module: str) -> str:
    """Name and version of the distribution that installs a top module; the module's name if none does."""
    try:
        return f"{module} {version(module)}"
    except PackageNotFoundError:
        names = sorted(set(_distributions().get(module, ())))
        return ", ".join(f"{name} {version(name)}" for name in names) or module


def where(origin: str) -> str:
    """`standard`, `installed` or `own`."""
    if any(origin.startswith(folder) for folder in _installed()) or {"site-packages", "dist-packages"} & set(
        Path(origin).parts
    ):
        return "installed"
    standard = origin in ("built-in", "frozen") or any(origin.startswith(folder) for folder in _standard())
    return "standard" if standard else "own"


@cache
def _installed() -> tuple[str, ...]:
    found = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib"), *site.getsitepackages()}
    return tuple(os.path.join(folder, "") for folder in {*found, site.getusersitepackages()})


@cache
def _standard() -> tuple[str, ...]:
    return tuple(os.path.join(sysconfig.get_path(kind), "") for kind in ("stdlib", "platstdlib"))


def _spec(name: str, path: list[str], editable: bool) -> importlib.machinery.ModuleSpec | None:
    try:
        spec = importlib.machinery.PathFinder.find_spec(name, path)
        for finder in sys.meta_path if spec is None and editable else ():
            if getattr(finder, "__module__", "").startswith("__editable__"):  # of setuptools
                spec = spec or finder.find_spec(name, None)
    except (ImportError, ValueError, AttributeError, OSError):
        return None
    return spec
