"""A disk cache of compiled functions across processes, on top of numba's; unreadable entries count as missing.

A cached function refers to its modules by name. After an update that moved one of them, the entry cannot be loaded; it
is compiled again and replaced. Start reading at `cached`.
"""

from __future__ import annotations

import fcntl
import gc
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numba
from numba import config
from numba.core import sigutils
from numba.core.caching import FunctionCache
from numba.core.ccallback import CFunc
from numba.core.registry import CPUDispatcher

from worker.kernels.folder import cache_folder

if not os.environ.get("NUMBA_CACHE_DIR"):
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


class KernelCache(FunctionCache):
    """Numba's cache of one function."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The cached function for a signature; None if there is no entry, or none that this version can load."""
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError, EOFError, pickle.UnpicklingError):
            return None


@contextmanager
def _alone(function: Any) -> Iterator[None]:
    """Of several processes that need the same function, one compiles it; the others wait, and load it.

    The lock ends with its process. Where the folder cannot be written, everybody compiles.
    """
    folder = cache_folder() / "locks"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / f"{function.__module__}.{function.__qualname__}").open("w")
    except OSError:
        yield
        return
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@contextmanager
def _uncollected() -> Iterator[None]:
    """A compilation makes millions of objects and hardly any garbage: looking for it takes 6 % of the time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class _Cached(CPUDispatcher):
    """A dispatcher that compiles one signature in one process at a time."""

    def compile(self, sig: Any) -> Any:
        with _alone(self.py_func), _uncollected():
            return super().compile(sig)


class _CachedCallback(CFunc):
    def enable_caching(self) -> None:
        self._cache = KernelCache(self.__wrapped__)  # type: ignore[no-untyped-call]

    def compile(self) -> None:
        with _alone(self.__wrapped__), _uncollected():
            super().compile()


def cached(function: Callable[..., Any], **flags: Any) -> Any:
    """A function that is compiled at its first call and cached on disk."""
    made: Any = numba.njit(**flags)(function)
    made.__class__ = _Cached
    made._cache = KernelCache(function)  # type: ignore[no-untyped-call]
    return made


def cached_callback(function: Callable[..., Any], signature: Any, **flags: Any) -> Any:
    """A C callback, compiled now and cached on disk; its `address` is valid for as long as the object exists."""
    known = sigutils.normalize_signature(signature)  # type: ignore[no-untyped-call]
    made = _CachedCallback(function, known, locals={}, options=flags)
    made.enable_caching()
    made.compile()
    return made
