"""Fills the slots of a template and compiles it with numba's disk cache, or returns it as plain Python.

A slot is a global name of the template. Filling rebinds the function's globals instead of making a closure, because
numba cannot cache closures across processes. The digest in the bound function's name covers every function and constant
reachable from it, by value: an edit to an indirectly imported helper recompiles.
"""

from __future__ import annotations

import hashlib
import sys
import types
from collections.abc import Callable, Mapping
from typing import Any

import numba
import numpy as np

from worker.engine.kernels.maths import FLAGS
from worker.engine.kernels.numba_internals import cached, is_compiled, python

Function = Callable[..., Any]


def compile_loop(bound: Function, name: str, flags: Mapping[str, Any] = FLAGS) -> Any:
    """Compile a filled template; it is cached on disk under its digest and releases the GIL."""
    bound.__qualname__ = f"{name}_{digest(bound, flags)}"
    return cached(bound, nogil=True, **flags)


def filled(template: Function, slots: Mapping[str, object]) -> types.FunctionType:
    """A copy of a plain function with some of its globals replaced."""
    source = python(template)
    unknown = [name for name in slots if name not in source.__globals__]
    if unknown:
        raise ValueError(f"{source.__qualname__} has no slot named {', '.join(unknown)}")
    copy = types.FunctionType(source.__code__, {**source.__globals__, **slots}, source.__name__, source.__defaults__)
    copy.__qualname__ = source.__qualname__
    copy.__module__ = source.__module__
    return copy


def plain(function: Function, instead: Mapping[Any, Any] | None = None) -> Any:
    """The function and every kernel that it reaches in plain Python: for debuggers, coverage and DOP853.

    `instead` maps kernels to the functions to call in their place, and modules to modules.
    """
    done = {identity(kernel): other for kernel, other in (instead or {}).items()}
    return rebuilt(function, done, lambda copy: copy)


def identity(function: Any) -> int:
    """The key of a kernel in `rebuilt`; valid for as long as the kernel exists."""
    return id(python(function))


def digest(function: Function, flags: Mapping[str, Any] = FLAGS) -> str:
    """16 hexadecimal digits over bytecode and constants of everything reachable from the function, by value."""
    sink = hashlib.sha256(f"{numba.__version__} {sys.version} {sorted(flags.get('fastmath', ()))}".encode())
    _walk(function, sink.update, {})
    return sink.hexdigest()[:16]


def rebuilt(function: Function, done: dict[int, Any], make: Callable[[Function], Any]) -> Any:
    """The function and every kernel that it reaches, each converted by `make` from its plain Python form.

    `done` maps the `identity` of a kernel to its converted form; entries given at the start replace those kernels.
    """
    source = python(function)
    if id(source) in done:
        return done[id(source)]
    if _foreign(getattr(source, "__module__", "")):
        return function
    scope = dict(source.__globals__)
    cells = tuple(types.CellType() for _ in source.__closure__ or ())
    copy = types.FunctionType(source.__code__, scope, source.__name__, source.__defaults__, cells or None)
    done[id(source)] = copy
    names, modules = _names(source.__code__), dict[int, types.ModuleType]()
    for name in names & scope.keys():
        scope[name] = _plain_global(scope[name], names, modules, done, make)
    for cell, old in zip(cells, source.__closure__ or (), strict=True):
        cell.cell_contents = _plain_global(old.cell_contents, names, modules, done, make)
    done[id(source)] = make(copy)
    return done[id(source)]


def _plain_global(
    value: Any,
    names: set[str],
    modules: dict[int, types.ModuleType],
    done: dict[int, Any],
    make: Callable[[Function], Any],
) -> Any:
    """The plain form of a global; for a module of this project, a copy with the attributes that the code may use."""
    if is_compiled(value) or isinstance(value, types.FunctionType):
        return rebuilt(value, done, make)
    if not isinstance(value, types.ModuleType):
        return value
    if id(value) in done:
        return done[id(value)]
    if _foreign(value.__name__):
        return value
    if id(value) not in modules:
        copy = modules[id(value)] = types.ModuleType(value.__name__)
        for name in names & vars(value).keys():
            vars(copy)[name] = _plain_global(vars(value)[name], names, modules, done, make)
    return modules[id(value)]


def _foreign(module: str) -> bool:
    """Whether a module belongs to numpy, numba or the standard library: versions identify these functions."""
    return module.partition(".")[0] in ("numpy", "math", "numba", "builtins")


def _walk(value: Any, feed: Callable[[bytes], None], seen: dict[Any, int]) -> None:
    """Feed everything that a compiled function depends on; `seen` numbers objects by their first visit."""
    value = python(value)
    if isinstance(value, np.generic):
        feed(f"{value.dtype}:".encode())
        value = value.item()
    if isinstance(value, (bool, int, float, complex, str, bytes, type(None))):
        feed(f"{type(value).__name__}:{value!r};".encode())
        return
    if id(value) in seen:
        feed(f"again:{seen[id(value)]};".encode())
        return
    seen[id(value)] = len(seen)
    if isinstance(value, types.FunctionType):
        feed(b"function;")
        _walk_code(value.__code__, feed, seen)
        for name in sorted(_names(value.__code__)):
            if name in value.__globals__:
                feed(f"{name}=".encode())
                _walk_global(value.__globals__[name], _names(value.__code__), feed, seen)
        for cell in value.__closure__ or ():
            _walk(cell.cell_contents, feed, seen)
        _walk(value.__defaults__, feed, seen)
    elif isinstance(value, types.CodeType):
        _walk_code(value, feed, seen)
    elif isinstance(value, (tuple, list, frozenset, set)):
        items = sorted(value, key=repr) if isinstance(value, (set, frozenset)) else value
        feed(f"{type(value).__name__}{len(value)}(".encode())
        for item in items:
            _walk(item, feed, seen)
        feed(b");")
    elif isinstance(value, type):
        feed(f"class:{value.__module__}.{value.__qualname__}:{getattr(value, '_fields', ())!r};".encode())
        for name, default in getattr(value, "_field_defaults", {}).items():
            feed(f"{name}=".encode())
            _walk(default, feed, seen)
    elif isinstance(value, (np.ndarray, np.generic)):
        feed(f"{value.dtype.str}{value.shape}".encode())
        feed(value.tobytes())
    else:
        feed(f"{type(value).__module__}.{type(value).__qualname__}:{getattr(value, '__name__', '')};".encode())


def _walk_global(value: Any, names: set[str], feed: Callable[[bytes], None], seen: dict[Any, int]) -> None:
    """Feed a global; for a module of this project, every attribute that the function's code may use, recursively."""
    if isinstance(value, types.ModuleType):
        feed(f"module:{value.__name__};".encode())
        # Different code may use different attributes of the same module, so the names are part of the visit's key.
        visit = id(value), frozenset(names)
        if _foreign(value.__name__) or visit in seen:
            return
        seen[visit] = len(seen)
        for name in sorted(names & vars(value).keys()):
            feed(f"{name}=".encode())
            _walk_global(vars(value)[name], names, feed, seen)
    else:
        _walk(value, feed, seen)


def _names(code: types.CodeType) -> set[str]:
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            found |= _names(constant)
    return found


def _walk_code(code: types.CodeType, feed: Callable[[bytes], None], seen: dict[Any, int]) -> None:
    feed(code.co_code)
    feed(repr((code.co_names, code.co_varnames, code.co_freevars, code.co_argcount)).encode())
    for constant in code.co_consts:
        _walk(constant, feed, seen)
