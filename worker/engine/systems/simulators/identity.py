"""What identifies a function: a digest of its compiled code, its values, and the functions and modules that it uses.

The compiled code and not the source text: a file may have been edited since, and an interactive function may have no
text. Of a module of one's own what the function uses counts; of an installed package its version. What cannot be read
exactly (an object, an import of a computed name, whatever comes from files, the clock or the environment) is named
instead: then nothing identifies the function, and a verdict must state that. Declared data files count by content.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from worker.engine.systems.simulators.declared.outside import BUILTINS, METHODS, SEEDED, Outside, outside, public
from worker.engine.systems.simulators.declared.reached import OURS, data_files, distribution, where
from worker.engine.systems.simulators.declared.statements import EXECUTING, IMPORTING, LOADING
from worker.engine.systems.simulators.uses import Chain, Import, Uses, uses

DEEPEST = 40
NAMED = (BuiltinFunctionType, type, type(np.random.default_rng))
"""Functions of C and of Cython, and classes."""


@dataclass(frozen=True)
class Identity:
    """The digest (64 hexadecimal digits), and the first thing that could not be read; empty if everything was."""

    digest: str
    unknown: str = ""


def identified(call: Callable[..., Any], reads: Sequence[str] = ()) -> Identity:
    """The identity of a function as it is now; reads: its data files, relative to its file or to the working folder."""
    reader = _Reader()
    reader.data(call, reads)
    reader.take(call, getattr(call, "__name__", type(call).__name__))
    return Identity(reader.sink.hexdigest(), reader.unknown)


class _Reader:
    def __init__(self) -> None:
        self.sink = hashlib.sha256()
        self.unknown = ""
        self.seen: dict[int, Any] = {}
        """Objects by id, referred to here so that no id is used twice."""
        self.declared = False
        """Whether its data files are."""
        self.seeded: set[str] = set()
        """Generators of random numbers that the function gives a seed."""

    def data(self, call: Callable[..., Any], reads: Sequence[str]) -> None:
        """Add the data files of a function."""
        file = Path(getattr(getattr(call, "__code__", None), "co_filename", ""))
        found, missing = data_files(reads, file.parent if file.is_file() else Path.cwd())
        self.declared, self.unknown = bool(reads), missing
        for name, path in sorted(found.items()):
            self.put("data", name, path.read_bytes())

    def put(self, *parts: object) -> None:
        for part in parts:
            data = part if isinstance(part, bytes) else str(part).encode("utf-8", "surrogatepass")
            self.sink.update(f"{len(data)}:".encode() + data)

    def take(self, value: Any, name: str, depth: int = 0) -> None:
        """Add one value; `name` is what a sentence calls it."""
        kind = type(value)
        if value is None or value is Ellipsis or kind in (bool, int, float, complex, str, bytes):
            self.put(kind.__name__, repr(value) if kind is not bytes else value)
        elif id(value) in self.seen:
            self.put("again", list(self.seen).index(id(value)))
        elif depth > DEEPEST:
            self.miss(name)
        else:
            self.seen[id(value)] = value
            self._compound(value, name, depth + 1)

    def miss(self, name: str) -> None:
        self.put("unknown")
        self.unknown = self.unknown or name

    def read(self, dotted: str, name: str, where: str = "", kind: Outside | None = None) -> None:
        """Note what reads state outside of the function by its full name; kind: if that is known already."""
        kind = kind or (None if dotted in self.seeded else outside(dotted))
        if kind is not None and not (kind is Outside.FILES and self.declared):
            self.miss(kind.clause(name) + where)

    def _compound(self, value: Any, name: str, depth: int) -> None:
        kind = type(value)
        if kind in (tuple, list):
            self.put(kind.__name__, len(value))
            for k, inner in enumerate(value):
                self.take(inner, f"{name}[{k}]", depth)
        elif kind in (dict, set, frozenset):
            self._unordered(value, name, depth)
        elif isinstance(value, PurePath):
            self.put("path", value)
        elif kind is np.ndarray and not value.dtype.hasobject:
            self.put("array", value.dtype.str, value.shape, value.tobytes())
        elif isinstance(value, np.generic) and not value.dtype.hasobject:
            self.put("scalar", value.dtype.str, value.tobytes())
        else:
            self._callable(value, name, depth)

    def _unordered(self, value: Any, name: str, depth: int) -> None:
        if not all(type(k) in (str, int, float, bool, bytes) for k in value):
            self.miss(name)
            return
        self.put(type(value).__name__, len(value))
        # A function may see the order of a dict; that of a set differs between processes.
        for key in value if isinstance(value, Mapping) else sorted(value, key=repr):
            self.put(type(key).__name__, repr(key))
            if isinstance(value, Mapping):
                self.take(value[key], f"{name}[{key!r:.20}]", depth)

    def _callable(self, value: Any, name: str, depth: int) -> None:
        if isinstance(value, ModuleType):
            self.read("", value.__name__, kind=Outside.VALUE)
            self._module(value, [()])
        elif isinstance(value, FunctionType):
            self._function(value, depth)
        elif isinstance(value, functools.partial):
            self.put("partial")
            for k, part in enumerate((value.func, value.args, value.keywords)):
                self.take(part, f"{name} ({('function', 'arguments', 'keywords')[k]})", depth)
        elif isinstance(value, MethodType):
            self.miss(f"the object of the method {value.__name__}")
        elif isinstance(getattr(value, "py_func", None), FunctionType):  # compiled by numba
            self.put("compiled")
            self.take(value.py_func, name, depth)
        elif isinstance(value, np.ufunc) and not _of_a_package(value):
            self.miss(name)
        elif isinstance(value, (*NAMED, np.ufunc)) or hasattr(value, "_implementation"):
            self._named(value, name)
        else:
            self.miss(name)

    def _named(self, value: Any, name: str) -> None:
        """Something of an installed package or of C, by its name and the version of the package; not of a file here."""
        module = str(getattr(value, "__module__", "") or "builtins")
        version, owner = _installed(module), getattr(value, "__self__", None)
        loads = getattr(value, "__name__", "") in {*EXECUTING, *IMPORTING, *LOADING}
        if version is None or loads or not (owner is None or isinstance(owner, ModuleType)):
            self.miss(name)
        else:
            self.read(public(module, getattr(value, "__qualname__", name)), name)
            self.put("name", module, getattr(value, "__qualname__", getattr(value, "__name__", name)), version)

    def _function(self, function: FunctionType, depth: int) -> None:
        if depth > 1 and (version := _installed(str(function.__module__ or ""))) is not None:
            if function.__name__ in {*IMPORTING, *LOADING}:
                self.miss(f"what {function.__name__} imports")
            self.read(public(function.__module__, function.__qualname__), function.__name__)
            self.put("library", function.__module__, function.__qualname__, version)
            return
        self.put("function")
        self._code(function.__code__)
        for defaults in (function.__defaults__, function.__kwdefaults__):
            self.take(defaults, f"the defaults of {function.__name__}", depth)
        if function.__dict__:
            self.take(dict(function.__dict__), f"the attributes of {function.__name__}", depth)
        cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=False)
        used = {name: cell.cell_contents for name, cell in cells if not _empty(cell)}
        found = uses(function.__code__)
        known = function.__globals__
        used |= {name: known[name] for name in found.names if name in known and name in found.wide}
        self._outside(function, found, used)
        for name in sorted(used):
            self.put(name)
            if isinstance(used[name], ModuleType):
                self._module(used[name], found.chains(name), depth)
            else:
                self.take(used[name], name, depth)
        for name in sorted({*EXECUTING, "__import__"} & found.names.keys() - known.keys()):
            self.miss(f"what {name} executes")
        for one in found.imports:
            chains = [(*one.taken, *chain) for chain in found.chains(one.name) or [()]]
            self._import(one, chains, str(known.get("__package__") or ""), depth)
        if found.unread:
            self.miss(f"an import in {function.__name__}")

    def _outside(self, function: FunctionType, found: Uses, used: Mapping[str, Any]) -> None:
        """Note the names and methods in the code of a function that read state outside of it."""
        imported = {one.name: ".".join([one.base, *one.taken]) for one in found.imports if not one.level}
        for name, chains in found.names.items():
            for chain, line in chains.items():
                where = f", line {line} of {function.__name__}"
                dotted = ".".join((imported[name], *chain)) if name in imported else ""
                if name in used:
                    dotted = _dotted(used[name], chain)
                if dotted in SEEDED and (name, *chain) not in found.seedless:
                    self.seeded.add(dotted)
                kind = METHODS.get(chain[-1]) if chain and name in used and not dotted else None
                if name in BUILTINS and name not in used and name not in function.__code__.co_varnames:
                    kind = BUILTINS[name]
                self.read(dotted if _installed(dotted) else "", ".".join((name, *chain)), where, kind)
                if not chain and isinstance(used.get(name), ModuleType):
                    self.miss(Outside.VALUE.clause(used[name].__name__) + where)
        for name, line in found.methods.items():
            self.read("", name, f", line {line} of {function.__name__}", METHODS.get(name))

    def _import(self, one: Import, chains: Iterable[Chain], package: str, depth: int) -> None:
        """What the function imports when it is called."""
        dots = "." * one.level
        try:
            importlib.import_module(dots + one.module, package or None)
            base = importlib.import_module(dots + one.base, package or None)
            if one.taken and not hasattr(base, one.taken[0]):  # a module of a package
                importlib.import_module(f"{base.__name__}.{one.taken[0]}")
        except Exception:  # whatever its file raises; so will the call
            self.miss(f"the module {one.module or '.'}")
        else:
            self._module(base, chains, depth)

    def _module(self, module: ModuleType, chains: Iterable[Chain], depth: int = 0) -> None:
        """What these chains of attributes lead to; of an installed package the version counts."""
        version = _installed(module.__name__)
        if version is not None:
            self.put("module", module.__name__, version)
        for chain in chains:
            self.put(*chain)
            name = ".".join([module.__name__, *chain])
            if version is not None and {*chain} & {*EXECUTING, *IMPORTING, *LOADING}:
                self.miss(name)
            elif version is not None:
                self.read(name, name)
            elif version is None:
                self._attribute(module, chain, name, depth)

    def _attribute(self, module: ModuleType, chain: Chain, name: str, depth: int) -> None:
        """What a chain leads to, from a module of one's own to the first value or to an installed package."""
        value: Any = module
        for k, attribute in enumerate(chain):
            if not isinstance(value, ModuleType):
                break
            if _installed(value.__name__) is not None:
                self._module(value, [chain[k:]], depth)
                return
            value = getattr(value, attribute, None)
        if not isinstance(value, ModuleType):
            self.take(value, name, depth)
        elif _installed(value.__name__) is None:
            self.miss(f"the module {value.__name__}")
        else:
            self._module(value, [], depth)

    def _code(self, code: CodeType) -> None:
        self.put(code.co_code, code.co_names, code.co_varnames, code.co_freevars, code.co_flags, code.co_argcount)
        # Where a `try` begins and ends is in neither the instructions nor the constants.
        self.put(code.co_exceptiontable, code.co_kwonlyargcount, code.co_posonlyargcount)
        for constant in code.co_consts:
            if isinstance(constant, CodeType):
                self._code(constant)
            else:
                self.put(type(constant).__name__, _constant(constant))


def _dotted(value: Any, chain: Chain) -> str:
    """The full name of what a chain of attributes leads to; empty for an object of whatever kind."""
    if isinstance(value, ModuleType):
        for k, attribute in enumerate(chain):
            inner = getattr(value, attribute, None)
            if _installed(value.__name__) is not None or not isinstance(inner, ModuleType):
                return ".".join((value.__name__, *chain[k:]))
            value = inner
        return str(value.__name__)
    if isinstance(value, (FunctionType, *NAMED)):
        return ".".join((public(str(value.__module__ or ""), value.__qualname__), *chain))
    return ""


def _installed(module: str) -> str | None:
    """The version of the package that a module belongs to; None for a module of one's own."""
    top = module.partition(".")[0]
    if top in OURS:
        return distribution("clearance")
    loaded = sys.modules.get(top)
    origin = getattr(loaded, "__file__", None) or next(iter(getattr(loaded, "__path__", ())), "")
    if not origin:
        return sys.version if top in sys.stdlib_module_names else None
    kind = where(str(origin))
    return None if kind == "own" else sys.version if kind == "standard" else distribution(top)


def _of_a_package(value: np.ufunc) -> bool:
    """Whether it is found by its name; `numpy.frompyfunc` makes others, of any function."""
    places = (np, sys.modules.get("scipy.special"))
    return any(getattr(place, value.__name__, None) is value for place in places if place is not None)


def _empty(cell: CellType) -> bool:
    try:
        cell.cell_contents  # noqa: B018  a cell may have no value yet
    except ValueError:
        return True
    return False


def _constant(value: Any) -> str:
    """A constant of compiled code; sets in a fixed order, because that of their repr differs between processes."""
    if isinstance(value, frozenset):
        return f"frozenset({sorted(map(_constant, value))})"
    if isinstance(value, tuple):
        return f"({', '.join(map(_constant, value))})"
    return repr(value)
