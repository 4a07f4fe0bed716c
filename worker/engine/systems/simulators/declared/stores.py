"""Stores of results between the calls of a function in this process: `functools.cache` and `lru_cache`.

A call that such a store answers shows nothing of whether results repeat.
"""

from __future__ import annotations

import functools
import inspect
import sys
import sysconfig
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

CLEAR, WRAPPED = "cache_clear", "__wrapped__"
INSTALLED = tuple({sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")})

PLAIN = {type(None), bool, int, float, complex, str, bytes, list, tuple, dict, set, frozenset}
"""Types of values that hold no function that is called, or not by its name."""


def stores(call: Callable[..., Any]) -> list[Callable[[], object]]:
    """What clears each store of a function, of what it wraps, and of what its code names, methods and parts of modules
    included; not of what installed packages use themselves."""
    seen: dict[int, object] = {}
    waiting: list[Any] = [call]
    while waiting:
        one = waiting.pop()
        if id(one) not in seen and type(one) not in PLAIN:
            seen[id(one)] = one
            waiting += _named(one)
    return [getattr(one, CLEAR) for one in seen.values() if _stores(one)]


def _stores(one: object) -> bool:
    """Whether this is a function under a store; a class may have a method of that name for its own use."""
    has = [inspect.getattr_static(one, name, None) is not None for name in (CLEAR, WRAPPED)]
    return callable(one) and not isinstance(one, type) and all(has)


def _named(one: Any) -> Iterator[Any]:
    if isinstance(one, functools.partial):
        yield from (one.func, *one.args, *one.keywords.values())
    elif isinstance(one, MethodType):
        yield from (one.__func__, one.__self__)
    elif isinstance(one, FunctionType):
        yield from () if one.__code__.co_filename.startswith(INSTALLED) else _used(one)
    elif not isinstance(one, ModuleType):
        yield from _members(one)
    yield inspect.getattr_static(one, WRAPPED, None)
    yield inspect.getattr_static(one, "pyfunc", None)  # of numpy.vectorize


def _members(one: Any) -> Iterator[Any]:
    """What an object or a class of the function's own code consists of."""
    its = one if isinstance(one, type) else type(one)
    own = [each for each in its.__mro__ if not _installed(each)]
    for each in own:
        yield from list(vars(each).values())
    if own and one is not its:
        with suppress(TypeError):  # an object with slots only
            yield from list(vars(one).values())


def _installed(its: type) -> bool:
    name = str(its.__module__)
    file = getattr(sys.modules.get(name), "__file__", None) or ""
    return name in sys.builtin_module_names or file.startswith(INSTALLED)


def _used(function: FunctionType) -> Iterator[Any]:
    names = set(_names(function.__code__))
    waiting = [function.__globals__.get(name) for name in names]
    waiting += [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values(), *_closed(function)]
    modules: set[int] = set()
    for value in waiting:
        if not isinstance(value, ModuleType):
            yield value
        elif id(value) not in modules:
            modules.add(id(value))
            waiting += [vars(value).get(name) for name in names]


def _closed(function: FunctionType) -> Iterator[Any]:
    for cell in function.__closure__ or ():
        try:
            yield cell.cell_contents
        except ValueError:  # not assigned yet
            continue


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names(inner)
