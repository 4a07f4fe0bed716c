"""What identifies a function: a digest of its compiled code, its values, and the functions and modules that it uses.

The compiled code and not the source text: a file may have been edited since, and an interactive function may have no
text. Of a module of one's own what the function uses counts; of an installed package its version. What cannot be read
exactly (an object, a generator of random numbers, an import of a computed name) is named instead: then nothing
identifies the function, and a verdict must state that.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from worker.engine.systems.simulators.declared.reached import OURS, distribution, where
from worker.engine.systems.simulators.declared.statements import EXECUTING, IMPORTING, LOADING
from worker.engine.systems.simulators.uses import Chain, Import, uses

DEEPEST = 40


@dataclass(frozen=True)
class Identity:
    """The digest (64 hexadecimal digits), and the first thing that could not be read; empty if everything was."""

    digest: str
    unknown: str = ""


def identified(call: Callable[..., Any]) -> Identity:
    """The identity of a function as it is now."""
    reader = _Reader()
    reader.take(call, getattr(call, "__name__", type(call).__name__))
    return Identity(reader.sink.hexdigest(), reader.unknown)


class _Reader:
    def __init__(self) -> None:
        self.sink = hashlib.sha256()
        self.unknown = ""
        self.seen: dict[int, Any] = {}
        """Objects by id, referred to here so that no id is used twice."""

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

    def _compound(self, value: Any, name: str, depth: int) -> None:
        kind = type(value)
        if kind in (tuple, list):
            self.put(kind.__name__, len(value))
            for k, inner in enumerate(value):
                self.take(inner, f"{name}[{k}]", depth)
        elif kind in (dict, set, frozenset):
            self._unordered(value, name, depth)
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
        for key in sorted(value, key=repr):
            self.put(type(key).__name__, repr(key))
            if isinstance(value, Mapping):
                self.take(value[key], f"{name}[{key!r:.20}]", depth)

    def _callable(self, value: Any, name: str, depth: int) -> None:
        if isinstance(value, ModuleType):
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
        elif isinstance(value, (BuiltinFunctionType, np.ufunc, type)) or hasattr(value, "_implementation"):
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
            self.put("name", module, getattr(value, "__qualname__", getattr(value, "__name__", name)), version)

    def _function(self, function: FunctionType, depth: int) -> None:
        if depth > 1 and (version := _installed(str(function.__module__ or ""))) is not None:
            if function.__name__ in {*IMPORTING, *LOADING}:
                self.miss(f"what {function.__name__} imports")
            self.put("library", function.__module__, function.__qualname__, version)
            return
        self.put("function")
        self._code(function.__code__)
        for defaults in (function.__defaults__, function.__kwdefaults__):
            self.take(defaults, f"the defaults of {function.__name__}", depth)
        cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=False)
        used = {name: cell.cell_contents for name, cell in cells if not _empty(cell)}
        found = uses(function.__code__)
        known = function.__globals__
        used |= {name: known[name] for name in found.names if name in known}
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

    def _import(self, one: Import, chains: Sequence[Chain], package: str, depth: int) -> None:
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

    def _module(self, module: ModuleType, chains: Sequence[Chain], depth: int = 0) -> None:
        """What these chains of attributes lead to; of an installed package the version counts."""
        version = _installed(module.__name__)
        if version is not None:
            self.put("module", module.__name__, version)
        for chain in chains:
            self.put(*chain)
            name = ".".join([module.__name__, *chain])
            if version is not None and {*chain} & {*EXECUTING, *IMPORTING, *LOADING}:
                self.miss(name)
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
        for constant in code.co_consts:
            if isinstance(constant, CodeType):
                self._code(constant)
            else:
                self.put(type(constant).__name__, _constant(constant))


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
