"""A disk cache of compiled functions across processes, on top of numba's; unreadable entries count as missing.

A cached function refers to its modules by name. After an update that moved one of them, the entry cannot be loaded; it
is compiled again and replaced. Start reading at `cached`.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba import config

from worker.engine.kernels import numba_internals
from worker.engine.kernels.durations import Watched
from worker.engine.kernels.folder import cache_folder

if not os.environ.get("NUMBA_CACHE_DIR"):
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


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
    """Of several processes that need the same function, one compiles it; the others wait, and load it.

    The lock ends with its process. Where the folder cannot be written, everybody compiles. wait: called before waiting.
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
def _compiling(function: Any) -> Iterator[Callable[[], None]]:
    """Around the first call of a function: one process compiles it, and this is reported and timed."""
    with _watched(function) as watched, _alone(function, watched.wait):
        yield watched.compile


def cached(function: Callable[..., Any], **flags: Any) -> Any:
    """A function that is compiled at its first call and cached on disk."""
    return numba_internals.cached(function, _compiling, **flags)


def cached_callback(function: Callable[..., Any], signature: Any, **flags: Any) -> Any:
    """A C callback, compiled now and cached on disk; its `address` is valid for as long as the object exists."""
    return numba_internals.cached_callback(function, signature, _compiling, **flags)
