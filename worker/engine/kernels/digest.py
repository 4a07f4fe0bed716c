"""What a compiled function depends on, by value: `digest` identifies a loop, `stamp` its machine code on disk.

Bytecode, constants and compiler flags of everything that is reachable from the function, never a path or a time of a
file: an edit to an indirectly imported helper changes the digest, a copy of the package in another folder does not.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
import types
from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any

import llvmlite
import numba
import numpy as np

from worker.engine.kernels.numba_internals import (
    FLAGS,
    SOURCE,
    Stamp,
    by_options,
    extensions,
    is_compiled,
    options,
    python,
)

Function = Callable[..., Any]

SETTINGS = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "USING_SVML")
"""What changes machine code among numba's settings of a process. Its own key has processor, features and platform."""

NAMED = (types.BuiltinFunctionType, types.MethodDescriptorType, types.WrapperDescriptorType, np.ufunc, type(np.sum))
"""Functions of C, which versions identify."""

KINDS = inspect.CO_VARARGS | inspect.CO_VARKEYWORDS | inspect.CO_GENERATOR
"""The flags of code that say how it is called. Numba changes others while a profiler runs."""

PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis), range, slice)


def digest(function: Function, flags: Mapping[str, Any] = FLAGS) -> str:
    """16 hexadecimal digits over bytecode and constants of everything reachable from the function, by value."""
    walk = _Walk()
    walk.text(f"{numba.__version__} {sys.version} {sorted(flags.get('fastmath', ()))}")
    walk.value(function)
    return walk.sink.hexdigest()[:16]


def stamp(function: Function, kind: str, flags: Mapping[str, Any]) -> Stamp:
    """Identifies the machine code of a function on one kind of processor; kind: what is made of it."""
    walk = _Walk()
    versions = (sys.version, numba.__version__, llvmlite.__version__, np.__version__, SOURCE)
    walk.text(f"{kind}:{versions}:{[getattr(numba.config, name, None) for name in SETTINGS]}:{by_options(flags)};")
    walk.value(function)
    for more, of, how in extensions(foreign):
        walk.text(f"extension:{how};")
        walk.value((of, more))
    return Stamp(walk.sink.hexdigest(), walk.unknown)


def foreign(module: str) -> bool:
    """Whether a module belongs to numpy, numba or the standard library: versions identify these functions."""
    top = module.partition(".")[0]
    return top in ("numpy", "numba", "llvmlite") or top in sys.stdlib_module_names


class _Walk:
    """Feeds values into a digest; functions, classes, modules and what may contain itself are numbered by their first
    visit."""

    def __init__(self) -> None:
        self.sink = hashlib.sha256()
        self.unknown = ""
        self.seen: dict[Any, int] = {}
        self.alive: list[Any] = []
        """What is numbered by its address."""

    def text(self, text: str) -> None:
        self.sink.update(text.encode("utf-8", "surrogatepass"))

    def again(self, value: Any, key: Any) -> bool:
        """Whether it was visited before, which is fed then."""
        if key in self.seen:
            self.text(f"again:{self.seen[key]};")
            return True
        self.seen[key] = len(self.seen)
        self.alive.append(value)
        return False

    def value(self, value: Any, names: frozenset[str] = frozenset()) -> None:
        """Feed a value; names: those that the code around it uses, of which modules may have some."""
        if is_compiled(value):
            self.text(f"compiled:{options(value)};")
        source = python(value)
        if source is not value and not is_compiled(value):
            self.text(f"{type(value).__name__};")
        if isinstance(source, types.ModuleType):
            self.module(source, names)
        elif isinstance(source, types.FunctionType):
            self.function(source)
        elif isinstance(source, type):
            self.kind(source)
        else:
            self.constant(source)

    def constant(self, value: Any) -> None:
        if isinstance(value, Enum):
            self.text(f"member:{value.name}=")
            self.value(type(value))
            self.value(value.value)
        elif isinstance(value, (np.ndarray, np.generic)):
            self.array(value)
        elif isinstance(value, PLAIN):
            self.text(f"{type(value).__name__}:{value!r};")
        elif isinstance(value, types.CodeType):
            self.code(value)
        elif isinstance(value, (tuple, list, frozenset, set, dict)):
            self.container(value)
        elif isinstance(value, numba.types.Type | np.dtype):
            self.text(f"type:{value!r}:{getattr(value, 'key', '')!r};")
        else:
            self.text(f"{type(value).__module__}.{type(value).__qualname__}:")
            self.text(f"{getattr(value, '__module__', '')}.{getattr(value, '__name__', '')};")
            if not isinstance(value, NAMED):
                self.unknown = self.unknown or f"{getattr(value, '__name__', '')} ({type(value).__qualname__})".strip()

    def array(self, value: Any) -> None:
        """What numba makes constants of, with the layout that it computes addresses from."""
        self.text(f"{value.dtype!r}{value.shape}{value.strides}{value.flags.aligned}:")
        self.sink.update(value.tobytes())
        if value.dtype.hasobject:
            self.unknown = self.unknown or "an array of objects"

    def container(self, value: Any) -> None:
        if isinstance(value, (list, dict)) and self.again(value, id(value)):
            return
        if type(value) not in (tuple, list, frozenset, set, dict):
            self.value(type(value))  # the order of a named tuple's fields
        items = sorted(value, key=repr) if isinstance(value, (set, frozenset)) else list(value)
        items += value.values() if isinstance(value, dict) else ()
        self.text(f"{type(value).__name__}{len(value)}(")
        for item in items:
            self.value(item)
        self.text(");")

    def kind(self, value: type) -> None:
        if self.again(value, id(value)):
            return
        self.text(f"class:{value.__module__}.{value.__qualname__}:{getattr(value, '_fields', ())!r};")
        for name, default in getattr(value, "_field_defaults", {}).items():
            self.text(f"{name}=")
            self.value(default)
        if issubclass(value, Enum):
            for member in value:
                self.constant(member)

    def function(self, value: types.FunctionType) -> None:
        if self.again(value, id(value)):
            return
        home = value.__globals__.get("__name__", "")
        if foreign(home):
            self.text(f"function:{home}.{value.__qualname__};")
            return
        self.text("function;")
        self.code(value.__code__)
        names = names_of(value.__code__)
        for name in sorted(names & value.__globals__.keys()):
            self.text(f"{name}=")
            self.value(value.__globals__[name], names)
        for cell in value.__closure__ or ():
            self.value(cell.cell_contents, names)
        self.value(value.__defaults__)
        self.value(value.__kwdefaults__)

    def module(self, value: types.ModuleType, names: frozenset[str]) -> None:
        """Add every attribute of a module of this project that the function's code may use, recursively."""
        self.text(f"module:{value.__name__};")
        # Different code may use different attributes of the same module, so the names are part of the visit's key.
        if foreign(value.__name__) or self.again(value, (id(value), names)):
            return
        if "__getattr__" in vars(value):
            self.unknown = self.unknown or f"attributes of {value.__name__}, which computes them"
        for name in sorted(names & vars(value).keys()):
            self.text(f"{name}=")
            self.value(vars(value)[name], names)

    def code(self, code: types.CodeType) -> None:
        flags = code.co_flags & KINDS
        arguments = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, flags)
        self.text(repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars, *arguments)))
        self.sink.update(code.co_code + code.co_exceptiontable)
        self.value(code.co_consts)


def names_of(code: types.CodeType) -> frozenset[str]:
    """The names that code may look up, with those that it gives to `getattr`."""
    found = set(code.co_names)
    if "getattr" in found:
        found.update(constant for constant in code.co_consts if isinstance(constant, str))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            found |= names_of(constant)
    return frozenset(found)
