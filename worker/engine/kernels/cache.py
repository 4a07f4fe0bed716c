"""A disk cache of compiled functions across processes, on top of numba's; unreadable entries count as missing.

A cached function refers to its modules by name. After an update that moved one of them, the entry cannot be loaded; it
is compiled again and replaced.
"""

from __future__ import annotations

import fcntl
import gc
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numba
from numba import config
from numba.core import sigutils
from numba.core.caching import FunctionCache
from numba.core.ccallback import CFunc
from numba.core.registry import CPUDispatcher

from worker.engine.kernels.durations import Watched
from worker.engine.kernels.folder import cache_folder

if not os.environ.get("NUMBA_CACHE_DIR"):
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


class KernelCache(FunctionCache):
    """Numba's cache of one function."""

    missed: Callable[[], None] | None = None
    """Called once if the next look-up finds nothing, so that a compilation begins."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The cached function for a signature; None if there is no entry, or none that this version can load."""
        found = None
        with suppress(ImportError, AttributeError, EOFError, pickle.UnpicklingError):
            found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        missed, self.missed = self.missed, None
        if found is None and missed is not None:
            missed()
        return found


@contextmanager
def _watched(function: Any) -> Iterator[Watched]:
    """Report and time the compilation, if there is one."""
    watched, succeeded = Watched(function, cache_folder()), False
    try:
        yield watched
        succeeded = True
    finally:
        watched.end(succeeded)


@contextmanager
def _alone(function: Any, wait: Callable[[], None]) -> Iterator[None]:
    """Hold the lock of a function: of several processes that need it, one compiles it, the others wait and load it.

    The lock ends with its process. Without a folder that can be written, each compiles. wait: called before waiting.
    """
    folder = cache_folder() / "locks"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / f"{function.__module__}.{function.__qualname__}").open("w")
    except OSError:
        yield
        return
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            wait()
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

    _cache: Any

    def compile(self, sig: Any) -> Any:
        with _watched(self.py_func) as watched, _alone(self.py_func, watched.wait), _uncollected():
            self._cache.missed = watched.compile
            return super().compile(sig)


class _CachedCallback(CFunc):
    def enable_caching(self) -> None:
        self._cache = KernelCache(self.__wrapped__)  # type: ignore[no-untyped-call]

    def compile(self) -> None:
        function = self.__wrapped__
        with _watched(function) as watched, _alone(function, watched.wait), _uncollected():
            self._cache.missed = watched.compile
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
