"""The operator's own components: files in the folders that CLEARANCE_COMPONENTS lists, each examined before it is used.

A file is examined in a process of its own (`worker.running.examination`), once for each content: whatever it does (an
error, a crash, an endless loop), it is reported and skipped.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import json
import os
import re
import secrets
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.metadata import entry_points
from importlib.util import resolve_name
from pathlib import Path
from traceback import walk_tb
from typing import Any, NamedTuple

from campaigns.catalogue import Kind, UnusableEntry
from worker.engine.components.own import BUSY, FOLDERS, TIMEOUT, folders, listed
from worker.engine.kernels.folder import cache_folder, store
from worker.running.catalogue.alone import NoAnswer, answer_of

PACKAGE = "worker.engine.components.own"
PROCESS = "worker.running.examination"
LONGEST = 60.0
"""Time for examining a file [s]."""
PHASES = 3
"""Parts of it that may each take as much of that time: starting, importing the file, simulating it."""
AGAIN = 600.0
"""A file whose examination took too long is examined again after this time [s]: the machine may have been busy."""


@dataclass(frozen=True)
class OwnFile:
    """A file that was examined: role and name of its component, or what is wrong with it and in which line."""

    file: Path
    role: str = ""
    name: str = ""
    title: str = ""
    simulated: bool = True
    text: str = ""
    line: int = 0
    note: str = ""
    """What does not hold of runs with a component that can be used."""

    @property
    def module(self) -> str:
        """The module that the file is imported as."""
        return f"{PACKAGE}.{self.file.stem}"

    @property
    def entry(self) -> UnusableEntry:
        """How the catalogue reports it if it cannot be used."""
        return unusable(self.file, self.text, self.line, self.name)


def unusable(file: Path | None, text: str, line: int = 0, name: str = "", kind: Kind = "component") -> UnusableEntry:
    """An entry of the catalogue for what was skipped; name: of the component, if it is known."""
    shown = "" if file is None else f"{file.parent.name}/{file.name}"
    known = name or ("" if file is None else file.stem)
    return UnusableEntry(file=shown, line=line or None, name=known, text=text, kind=kind)


def files() -> list[Path]:
    """The files of the folders that are components, in order; of two with the same name the first one."""
    found: dict[str, Path] = {}
    for folder in folders():
        for file in sorted(folder.glob("*.py")):
            if not file.name.startswith("_") and is_component(file):
                found.setdefault(file.stem, file)
    return list(found.values())


def missing() -> list[str]:
    """What is wrong with the list of folders, a sentence each."""
    gone = [folder for folder in listed() if not folder.is_dir()]
    return [f"{FOLDERS} names {folder}, which is not a folder: create it or correct the name" for folder in gone]


def is_component(file: Path) -> bool:
    """Whether a file means to declare a component; other Python files are left alone."""
    try:
        content = file.read_bytes()
    except OSError:
        return True  # reported
    return re.search(rb"worker\.(engine\.)?(kernels|components)\b", content) is not None


def examined() -> list[OwnFile]:
    """Every file of the operator's folders; of two components with the same role and name the second is refused."""
    found: list[OwnFile] = []
    first: dict[tuple[str, str], Path] = {}
    for file in files():
        one = examine(file)
        if not one.text and (earlier := first.setdefault((one.role, one.name), file)) != file:
            text = f"{earlier.name} already declares the {one.role} {one.name!r}: rename one of them"
            one = replace(one, text=text, line=_line_of_name(file))
        found.append(one)
    return [*found, *_hidden(found)]


def beside_others(one: OwnFile) -> OwnFile:
    """The file, refused if another one of its folder or of the operator's declares the same."""
    taken = declaring(one.role, one.name, one.file.parent, one.file)
    if taken is None:
        return one
    text = f"{taken} also declares the {one.role} {one.name!r}: rename one of them"
    return replace(one, text=text, line=_line_of_name(one.file))


def declaring(role: str, name: str, folder: Path, but: Path | None = None) -> Path | None:
    """The file that declares a component of this role and name as written, without executing any; None if none does."""
    for file in dict.fromkeys([*sorted(folder.glob("*.py")), *files()]):
        if file != but and declared_as(file) == (role.capitalize(), name):
            return file
    return None


def _hidden(found: Sequence[OwnFile]) -> Iterator[OwnFile]:
    """Files of later folders with the name of an earlier one."""
    used = {one.file.stem: one.file for one in found}
    for folder in folders():
        for file in sorted(folder.glob("*.py")):
            if file.stem in used and used[file.stem] != file and is_component(file):
                yield OwnFile(file, text=f"{used[file.stem]} has the same name and comes first: rename one of them")


def examine(file: Path) -> OwnFile:
    """Examine one file, or return the stored result for this content of it and of the files that it depends on."""
    vehicles = _vehicles(file)
    key = _key(file, vehicles)
    stored = _stored(key)
    if stored is None:
        stored = _examined(file, vehicles)
        store(_file(key), json.dumps(stored))
    return OwnFile(file, **{name: value for name, value in stored.items() if name != "until"})


def _examined(file: Path, vehicles: dict[str, Path]) -> dict[str, Any]:
    """What the process of the examination answers."""
    searched = os.pathsep.join(dict.fromkeys([str(file.parent), *map(str, folders())]))
    environment = {FOLDERS: searched, "PYTHONDONTWRITEBYTECODE": "1"}
    longest = float(os.environ.get(TIMEOUT) or LONGEST)
    mark = f"examined {secrets.token_hex(8)} "  # what the file prints is no answer
    try:
        modules = {name: f"{PACKAGE}.{other.stem}" for name, other in vehicles.items()}
        arguments = [str(file), json.dumps(modules), mark, f"{longest / PHASES:g}"]
        answer: dict[str, Any] = answer_of(PROCESS, arguments, mark, environment, longest)
        return answer if not answer.pop("overdue") else {**answer, "until": time.time() + AGAIN}
    except NoAnswer as error:
        if not error.started:
            return {"text": f"it could not be examined: {error}", "until": time.time()}
        advice = f"look for a loop that does not end; {BUSY}" if error.overdue else "remove what ends it"
        text = f"examining it {'took ' if error.overdue else ''}{error}: {advice}"
        return {"text": text, "until": time.time() + AGAIN}


def _key(file: Path, vehicles: dict[str, Path]) -> str:
    """Identifies the content of a file, of what it may import or fit, and of the examination itself."""
    sink = hashlib.sha256(f"{sys.version} {file.name} {_installation()}".encode())
    beside = sorted(p for p in file.parent.glob("_*.py"))
    for path in dict.fromkeys([file, *_imported(file), *beside, *vehicles.values()]):
        with contextlib.suppress(OSError):
            sink.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return sink.hexdigest()[:32]


@lru_cache(maxsize=1)
def _installation() -> str:
    """A digest of the code that components are examined with."""
    sink, root = hashlib.sha256(), Path(__file__).parents[2]
    for room in (
        "running/examination",
        *(f"engine/{r}" for r in ("kernels", "components", "physics", "systems/closed_loop")),
    ):
        for path in sorted((root / room).rglob("*.py")):
            sink.update(path.name.encode() + path.read_bytes())
    return sink.hexdigest()


def _stored(key: str) -> dict[str, Any] | None:
    try:
        found: Any = json.loads(_file(key).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(found, dict) or ("until" in found and found["until"] < time.time()):
        return None
    return found


def _file(key: str) -> Path:
    return cache_folder() / "examined" / f"{key}.json"


def _vehicles(file: Path) -> dict[str, Path]:
    """The files of own vehicles whose names the file mentions, by name: a controller is simulated with one."""
    found: dict[str, Path] = {}
    nodes = ast.walk(_tree(file))
    mentioned = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    for other in [*file.parent.glob("*.py"), *files()]:
        declared = declared_as(other) if other != file else None
        if declared is not None and declared[0] == "Vehicle" and declared[1] in mentioned:
            found.setdefault(declared[1], other)
    return found


def _tree(file: Path) -> ast.Module:
    try:
        return _parsed(file.read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module(body=[], type_ignores=[])


@lru_cache(maxsize=64)
def _parsed(content: bytes) -> ast.Module:
    return ast.parse(content)


def _declaration(file: Path) -> ast.Call | None:
    for node in _tree(file).body:
        if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Call):
            continue
        if any(isinstance(t, ast.Name) and t.id == "component" for t in node.targets):
            return node.value
    return None


def _name(file: Path) -> ast.Constant | None:
    call = _declaration(file)
    values = [] if call is None else [k.value for k in call.keywords if k.arg == "name"]
    return next((value for value in values if isinstance(value, ast.Constant)), None)


def declared_as(file: Path) -> tuple[str, str] | None:
    """Kind and name of a component as they are written, without executing the file."""
    call, name = _declaration(file), _name(file)
    if call is None or name is None or not isinstance(call.func, ast.Name):
        return None
    return call.func.id, str(name.value)


class Signals(NamedTuple):
    """The names of a vehicle's states and inputs."""

    states: tuple[str, ...]
    inputs: tuple[str, ...]


def signals(file: Path) -> Signals | None:
    """The states and inputs of a vehicle as they are written; None if they are not written one by one."""
    call = _declaration(file)
    found = {k.arg: _first_texts(k.value) for k in call.keywords} if call is not None else {}
    states, inputs = found.get("states", ()), found.get("inputs", ())
    return Signals(states, inputs) if states and inputs else None


def _first_texts(value: ast.expr) -> tuple[str, ...]:
    """The first argument of every call in a tuple, if all are texts."""
    calls = [e for e in value.elts if isinstance(e, ast.Call) and e.args] if isinstance(value, ast.Tuple) else []
    texts = [e.args[0].value for e in calls if isinstance(e.args[0], ast.Constant)]
    whole = isinstance(value, ast.Tuple) and len(texts) == len(value.elts)
    return tuple(str(text) for text in texts) if whole else ()


def _line_of_name(file: Path) -> int:
    name = _name(file)
    return 0 if name is None else name.lineno


def _imported(file: Path, seen: frozenset[Path] = frozenset()) -> list[Path]:
    """The files of the same folder that a file imports, and those that they import."""
    found: list[Path] = []
    for node in ast.walk(_tree(file)):
        if isinstance(node, ast.ImportFrom) and node.level:
            names = [node.module] if node.module else [alias.name for alias in node.names]
            for name in names:
                path = file.parent / f"{name.partition('.')[0]}.py"
                if path.is_file() and path not in seen and path != file:
                    found += [path, *_imported(path, seen | {file, path, *found})]
    return found


def modules_of(module: str, paths: dict[str, Path]) -> list[str]:
    """A module of this package and those of it that it imports, of the modules with these files."""
    file = paths.get(module)
    return [] if file is None else sorted({module, *(f"{PACKAGE}.{path.stem}" for path in _imported(file))})


def code_of(module: str, paths: dict[str, Path]) -> str:
    """The digest of a module of this package and of those that it imports, without comments and docstrings; empty for
    a module of another one."""
    return _digest(paths[name] for name in modules_of(module, paths) if name in paths)


def code_of_package(module: str) -> str:
    """The digest of a module of another package and of those of that package that it imports, as `code_of`."""
    files, waiting = dict[str, Path](), [module]
    while waiting:
        name = waiting.pop()
        loaded = sys.modules.get(name)
        file = str(getattr(loaded, "__file__", None))
        if name in files or not file.endswith(".py") or name.partition(".")[0] != module.partition(".")[0]:
            continue
        files[name] = Path(file)
        package = name if hasattr(loaded, "__path__") else name.rpartition(".")[0]
        for node in ast.walk(_tree(files[name])):
            if isinstance(node, ast.Import):
                waiting += [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = resolve_name("." * node.level + (node.module or ""), package) if node.level else str(node.module)
                parts = [f"{base}.{alias.name}" for alias in node.names]
                waiting += [part if part in sys.modules else base for part in parts]
    return _digest(files[name] for name in sorted(files))


def _digest(files: Iterable[Path]) -> str:
    texts = [_code(file) for file in files]
    return hashlib.sha256("\0".join(texts).encode()).hexdigest() if texts else ""


def _code(file: Path) -> str:
    tree = ast.parse(file.read_bytes())
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [each for each in body if not _is_text(each)] or [ast.Pass()]  # type: ignore[attr-defined]
    return ast.unparse(tree)


def _is_text(statement: ast.stmt) -> bool:
    """Whether it is a docstring, or a text after a declaration."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Constant) and isinstance(value.value, str)


def blamed(error: BaseException) -> str:
    """The sentence (file, line, message) for an exception of an own component or of a package's; empty otherwise."""
    found = ""
    own = {str(folder) for folder in folders()}
    named = (sys.modules.get(entry.module) for entry in entry_points(group="clearance.components"))
    others = {getattr(module, "__file__", None) for module in named}
    for frame, line in walk_tb(error.__traceback__):
        file = Path(frame.f_code.co_filename)
        if str(file.parent) in own or str(file) in others:
            text = " ".join(str(error).split())[:300].rstrip(".")
            found = f"{file}, line {line}: {type(error).__name__}: {text or 'without a message'}"
    return found
