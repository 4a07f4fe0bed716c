"""The disk cache of compiled functions: its folder, and the processes that need the same one: `compiling`."""

from __future__ import annotations

import fcntl
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba import config

from worker.engine.kernels.durations import Watched
from worker.engine.kernels.folder import cache_folder

if not os.environ.get("NUMBA_CACHE_DIR"):
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]

_outermost = threading.local()
"""Whether the thread compiles a function."""


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
def compiling(function: Any) -> Iterator[Callable[[], None]]:
    """Around the first call of a function: what is called if it is not cached, so that it is compiled here.

    One that is compiled for another belongs to that: with a lock of its own it could wait for a thread that compiles it
    alone, and that one for the compiler.
    """
    if getattr(_outermost, "begun", False):
        yield lambda: None
        return
    with Watched(function, cache_folder()) as watched, _alone(function, watched.wait):
        _outermost.begun = True
        try:
            yield watched.compile
        finally:
            _outermost.begun = False
