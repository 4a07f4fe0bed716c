"""Limits the linear algebra of NumPy and SciPy to one thread: the bits of a result then depend on nothing else.

OpenBLAS divides a factorisation among as many threads as the machine has cores, and the last digits follow the
division. Both packages contain an OpenBLAS of their own, which this sets directly; with another library the block runs
with the number of threads that it has.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy


class _Library(NamedTuple):
    get: Callable[[], int]
    set: Callable[[int], None]


_turn = threading.RLock()
_inside = 0
_before: list[int] = []


@contextmanager
def one_thread() -> Iterator[None]:
    """The linear algebra inside this block runs on one thread; afterwards on as many as before.

    The number belongs to the process. Blocks may overlap: the last one to end restores it.
    """
    global _inside, _before
    with _turn:
        if _inside == 0:
            _before = [library.get() for library in _libraries()]
            for library in _libraries():
                library.set(1)
        _inside += 1
    try:
        yield
    finally:
        with _turn:
            _inside -= 1
            if _inside == 0:
                for library, threads in zip(_libraries(), _before, strict=True):
                    library.set(threads)


@cache
def _libraries() -> tuple[_Library, ...]:
    found = []
    for package in (np, scipy):
        folder = Path(str(package.__file__)).resolve().parent
        for place in (folder.parent / f"{package.__name__}.libs", folder / ".dylibs"):
            found += [_opened(file) for file in sorted(place.glob("*openblas*"))]
    return tuple(library for library in found if library is not None)


def _opened(file: Path) -> _Library | None:
    try:
        loaded = ctypes.CDLL(str(file))  # loaded already: this gives the same library once more
    except OSError:
        return None
    for prefix in ("scipy_", ""):
        for suffix in ("64_", ""):
            get = getattr(loaded, f"{prefix}openblas_get_num_threads{suffix}", None)
            put = getattr(loaded, f"{prefix}openblas_set_num_threads{suffix}", None)
            if get is not None and put is not None:
                get.argtypes, get.restype = [], ctypes.c_int
                put.argtypes, put.restype = [ctypes.c_int], None
                return _Library(get, put)
    return None
