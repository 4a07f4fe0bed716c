"""Stores of results between the calls of a function in this process: `functools.cache` and `lru_cache`.

A call that such a store answers shows nothing of whether results repeat.
"""

from __future__ import annotations

import functools
import inspect
import sysconfig
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

CLEAR = "cache_clear"
INSTALLED = tuple({sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")})


def stores(call: Callable[..., Any]) -> list[Callable[[], object]]:
    """What clears each store of a function, of what it wraps, and of what its code names; not of what installed
    packages use themselves."""
    seen: dict[int, object] = {}
    waiting: list[Any] = [call]
    while waiting:
        one = waiting.pop()
        if id(one) not in seen and callable(one):
            seen[id(one)] = one
            waiting += _named(one)
    return [getattr(one, CLEAR) for one in seen.values() if inspect.getattr_static(one, CLEAR, None) is not None]


def _named(one: Any) -> Iterator[Any]:
    if isinstance(one, functools.partial):
        yield one.func
    elif isinstance(one, MethodType):
        yield one.__func__
    elif isinstance(one, FunctionType):
        yield from () if one.__code__.co_filename.startswith(INSTALLED) else _used(one)
    elif not isinstance(one, type):
        yield type(one).__call__
    yield inspect.getattr_static(one, "__wrapped__", None)


def _used(function: FunctionType) -> Iterator[Any]:
    names = list(_names(function.__code__))
    for value in [function.__globals__.get(name) for name in names]:
        yield from map(vars(value).get, names) if isinstance(value, ModuleType) else (value,)
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
