"""Fills the slots of a template and compiles it with numba's disk cache, or returns it as plain Python.

A slot is a global name of the template. Filling rebinds the function's globals.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Mapping
from typing import Any

from worker.engine.kernels.cached import cached
from worker.engine.kernels.digest import digest, foreign, names_of
from worker.engine.kernels.numba_internals import FLAGS, is_compiled, python

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


def rebuilt(function: Function, done: dict[int, Any], make: Callable[[Function], Any]) -> Any:
    """The function and every kernel that it reaches, each converted by `make` from its plain Python form.

    `done` maps the `identity` of a kernel to its converted form; entries given at the start replace those kernels.
    """
    source = python(function)
    if id(source) in done:
        return done[id(source)]
    if foreign(getattr(source, "__module__", "")):
        return function
    scope = dict(source.__globals__)
    cells = tuple(types.CellType() for _ in source.__closure__ or ())
    copy = types.FunctionType(source.__code__, scope, source.__name__, source.__defaults__, cells or None)
    done[id(source)] = copy
    names, modules = names_of(source.__code__), dict[int, types.ModuleType]()
    for name in names & scope.keys():
        scope[name] = _plain_global(scope[name], names, modules, done, make)
    for cell, old in zip(cells, source.__closure__ or (), strict=True):
        cell.cell_contents = _plain_global(old.cell_contents, names, modules, done, make)
    done[id(source)] = make(copy)
    return done[id(source)]


def _plain_global(
    value: Any,
    names: frozenset[str],
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
    if foreign(value.__name__):
        return value
    if id(value) not in modules:
        copy = modules[id(value)] = types.ModuleType(value.__name__)
        for name in names & vars(value).keys():
            vars(copy)[name] = _plain_global(vars(value)[name], names, modules, done, make)
    return modules[id(value)]
