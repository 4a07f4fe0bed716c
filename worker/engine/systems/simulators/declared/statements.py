"""What a Python file imports and reads, read from its text: names, folders of the path, and what cannot be read.

`worker.engine.systems.simulators.declared.reached` follows the names. Only the standard library is used.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from worker.engine.systems.simulators.declared.external import Use, external

IMPORTING = frozenset({"import_module", "__import__"})
EXECUTING = frozenset({"exec", "eval"})
LOADING = frozenset({
    "spec_from_file_location", "spec_from_loader", "SourceFileLoader", "SourcelessFileLoader", "ExtensionFileLoader",
    "exec_module", "load_module", "load_source", "run_path", "run_module", "CDLL", "PyDLL", "LoadLibrary",
    "load_library", "dlopen",
})  # fmt: skip
"""Functions that load code by something else than the name of a module."""
MODULES = frozenset({"importlib", "builtins", "runpy", "imp"})
"""Modules of which nothing but an attribute may be used: a function of theirs could be anything."""


@dataclass(frozen=True)
class Statements:
    """names: modules as written, with the number of leading dots; front, back: folders that the file puts before and
    after the others of `sys.path`; outside: what reads the state outside of it; data: the data files that it declares;
    unknown: a clause on the first thing that cannot be read, empty if there is none."""

    names: tuple[tuple[str, int], ...] = ()
    front: tuple[str, ...] = ()
    back: tuple[str, ...] = ()
    outside: tuple[Use, ...] = ()
    data: tuple[str, ...] = ()
    unknown: str = ""


def statements(file: Path) -> Statements:
    """The statements of a file; raises OSError."""
    at = file.stat()
    return _read(file, (at.st_mtime_ns, at.st_size, at.st_ino))


@lru_cache(maxsize=4096)
def _read(file: Path, _mark: tuple[int, int, int]) -> Statements:
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return Statements()  # it cannot be imported either
    reader = _Reader(file, tree)
    reader.read()
    besides = external(tree)
    data = tuple(reader.data(besides.reads))
    unknown = ""
    if reader.unknown:
        line, what = min(reader.unknown)
        unknown = f"{what}, line {line} of {file.name}"
    names = tuple(dict.fromkeys(reader.names))
    return Statements(names, tuple(reader.front), tuple(reader.back), tuple(besides.uses), data, unknown)


class _Reader:
    def __init__(self, file: Path, tree: ast.Module) -> None:
        self.file, self.tree = file, tree
        self.names: list[tuple[str, int]] = []
        self.front: list[str] = []
        self.back: list[str] = []
        self.unknown: list[tuple[int, str]] = []
        self.called: dict[str, str] = {}
        """Local names of functions and modules that import, by what they are."""
        self.plain: set[int] = set()
        """Expressions that were read as part of a larger one, by id."""

    def read(self) -> None:
        nodes = list(ast.walk(self.tree))
        for node in nodes:
            if isinstance(node, ast.Import | ast.ImportFrom):
                self._import(node)
        for node in nodes:
            if isinstance(node, ast.Call):
                self._call(node)
            elif isinstance(node, ast.Assign | ast.AugAssign):
                self._assign(node)
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                self.plain.add(id(node.value))
        for node in nodes:
            if isinstance(node, ast.Name | ast.Attribute) and id(node) not in self.plain:
                self._mention(node)

    def miss(self, node: ast.AST, what: str) -> None:
        self.unknown.append((getattr(node, "lineno", 0), what))

    def data(self, reads: list[ast.expr]) -> Iterator[str]:
        """The paths of declared data files, absolute or relative to the folder of the file."""
        for node in reads:
            path = _Folder(self.file, self.tree).text(node)
            if path is None:
                self.miss(node, "a computed path in reads")
            else:
                yield path

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        if isinstance(node, ast.Import):
            for alias in node.names:
                self.names.append((alias.name, 0))
                if alias.name.partition(".")[0] in MODULES:
                    self.called[alias.asname or alias.name.partition(".")[0]] = alias.name.partition(".")[0]
            return
        base = node.module or ""
        self.names.append((base, node.level))
        for alias in node.names:
            self.names.append((f"{base}.{alias.name}" if base else alias.name, node.level))
            if not node.level and base.partition(".")[0] in {*MODULES, "ctypes", "_ctypes"}:
                self.called[alias.asname or alias.name] = alias.name

    def _function(self, node: ast.expr) -> str:
        """What a name or an attribute is called where it comes from; empty for one that does not import."""
        if isinstance(node, ast.Name):
            found = self.called.get(node.id, node.id)
            return found if node.id in self.called or found in {*EXECUTING, "__import__"} else ""
        if isinstance(node, ast.Attribute):
            ours = isinstance(node.value, ast.Name) and node.value.id in ("builtins", "__builtins__")
            return node.attr if ours or node.attr in IMPORTING | LOADING else ""
        return ""

    def _call(self, node: ast.Call) -> None:
        name = self._function(node.func)
        if name in IMPORTING:
            self.plain.add(id(node.func))
            module = node.args[0] if node.args else None
            simple = (len(node.args) == 1 and not node.keywords) or name == "__import__"
            if (
                simple
                and isinstance(module, ast.Constant)
                and isinstance(module.value, str)
                and module.value[:1] != "."
            ):
                self.names.append((module.value, 0))
            else:
                self.miss(node, "the import of a computed name")
        elif name in ("CDLL", "PyDLL", "LoadLibrary") and _of_the_system(node):
            self.plain.add(id(node.func))
        elif _is_path(node.func, "insert", "append", "extend") or _is_named(node.func, "site", "addsitedir"):
            self._path(node, node.args[-1:], first=getattr(node.func, "attr", "") == "insert")

    def _assign(self, node: ast.Assign | ast.AugAssign) -> None:
        """Changes of `sys.path` by assignment."""
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            inner = target.value if isinstance(target, ast.Subscript) else target
            if _is_named(inner, "sys", "path"):
                self._path(node, [node.value], first=isinstance(node, ast.Assign))

    def _path(self, node: ast.AST, values: list[ast.expr], first: bool) -> None:
        entries = [e for value in values for e in (value.elts if isinstance(value, ast.List | ast.Tuple) else [value])]
        for entry in entries:
            if isinstance(entry, ast.Starred) and _is_named(entry.value, "sys", "path"):
                continue
            folder = _Folder(self.file, self.tree).text(entry)
            if folder is None:
                self.miss(node, "a computed folder in sys.path")
            elif first:
                self.front.insert(0, folder)
            else:
                self.back.append(folder)

    def _mention(self, node: ast.Name | ast.Attribute) -> None:
        """A function that imports, other than in a call that was read."""
        name = self._function(node)
        if name in EXECUTING:
            self.miss(node, f"code that {name} executes")
        elif name in IMPORTING or (isinstance(node, ast.Name) and name in MODULES):
            self.miss(node, "the import of a computed name")
        elif name in LOADING:
            self.miss(node, f"code that {name} loads")


def _is_named(node: ast.expr, module: str, attribute: str) -> bool:
    named = isinstance(node, ast.Attribute) and node.attr == attribute
    return named and isinstance(node.value, ast.Name) and node.value.id == module  # type: ignore[attr-defined]


def _is_path(node: ast.expr, *methods: str) -> bool:
    return isinstance(node, ast.Attribute) and node.attr in methods and _is_named(node.value, "sys", "path")


def _of_the_system(call: ast.Call) -> bool:
    """Whether a call loads a library of the system, by its name alone."""
    library = call.args[0] if call.args else None
    return isinstance(library, ast.Constant) and (library.value is None or os.sep not in str(library.value))


class _Folder:
    """The value of an expression that makes a path of `__file__` and constants."""

    def __init__(self, file: Path, tree: ast.Module) -> None:
        self.file = str(file)
        assigned = [n for n in tree.body if isinstance(n, ast.Assign) and isinstance(n.targets[0], ast.Name)]
        self.assigned = {n.targets[0].id: n.value for n in assigned}  # type: ignore[attr-defined]

    def text(self, node: ast.expr, depth: int = 0) -> str | None:
        """The text of an expression; None if it cannot be read."""
        if depth > 20:
            return None
        match node:
            case ast.Constant(value=str(value)):
                return value
            case ast.Name(id="__file__"):
                return self.file
            case ast.Name(id=name) if name in self.assigned:
                return self.text(self.assigned[name], depth + 1)
            case ast.Attribute(value=inner, attr="parent"):
                return _up(self.text(inner, depth + 1), 1)
            case ast.Subscript(value=ast.Attribute(value=inner, attr="parents"), slice=ast.Constant(value=int(n))):
                return _up(self.text(inner, depth + 1), n + 1)
            case ast.BinOp(left=left, op=ast.Div() | ast.Add(), right=right):
                return self._joined([left, right], os.sep if isinstance(node.op, ast.Div) else "", depth)
            case ast.Call(func=function, args=arguments, keywords=[]):
                return self._called(function, arguments, depth)
        return None

    def _called(self, function: ast.expr, arguments: list[ast.expr], depth: int) -> str | None:
        name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
        if name in ("resolve", "absolute", "as_posix") and isinstance(function, ast.Attribute) and not arguments:
            return self.text(function.value, depth + 1)
        if name == "dirname" and len(arguments) == 1:
            return _up(self.text(arguments[0], depth + 1), 1)
        if name in ("join", "joinpath"):
            base = [function.value] if name == "joinpath" and isinstance(function, ast.Attribute) else []
            return self._joined([*base, *arguments], os.sep, depth)
        if name in ("str", "Path", "PurePath", "fspath", "abspath", "realpath", "normpath") and len(arguments) == 1:
            return self.text(arguments[0], depth + 1)
        return None

    def _joined(self, parts: list[ast.expr], between: str, depth: int) -> str | None:
        texts = [self.text(part, depth + 1) for part in parts]
        found = [text for text in texts if text is not None]
        if len(found) < len(texts):
            return None
        return os.path.normpath(os.path.join(*found) if between else "".join(found))


def _up(path: str | None, levels: int) -> str | None:
    for _ in range(levels):
        path = None if path is None else os.path.dirname(path)
    return path
