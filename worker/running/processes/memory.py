"""A memory limit for simulating processes, so that one simulation cannot exhaust the memory of the machine; their
settings.

Source: setrlimit(2), RLIMIT_AS (Linux), which limits address space. LLVM and the threads' heaps map far more than they
use, so the limit is relative to what the process has mapped once it is ready.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from worker.engine.systems.threads import usual_threads

SETTING = "CLEARANCE_CHILD_MEMORY"
"""The environment variable: GiB in addition to what a ready process has mapped; 0 for no bound."""

THREADS = "CLEARANCE_THREADS"
"""Another one: see `usual_threads`."""

DEFAULT = 8.0
"""[GiB]"""

GIB = 2**30

THREAD = 128 * 2**20
"""Address space of a thread's stack and heap [bytes]; measured: 72 MiB."""


def allowed() -> float:
    """The setting [GiB]; infinite for no bound. Raises `ValueError` if it is not a number of GiB."""
    setting = os.environ.get(SETTING, "").strip()
    try:
        value = float(setting or DEFAULT)
    except ValueError:
        value = math.nan
    if not value >= 0:
        raise ValueError(f"invalid {SETTING} {setting!r}: give a number of GiB such as 8, or 0 for no bound")
    return value or math.inf


def refuse() -> None:
    """Raise `ValueError` where a setting of processes that simulate is no number; asked before one is started."""
    allowed()
    setting = os.environ.get(THREADS, "")
    if setting and not (setting.isascii() and setting.isdigit()):
        raise ValueError(f"invalid {THREADS} {setting!r}: give a number of threads such as 4, or 0 for one a core")


def bound(threads: int | None = None) -> None:
    """Limit the memory of this process from now on; call it after all imports. Exits if the setting is invalid.

    threads: the number of simulation threads, by default `usual_threads`.
    """
    try:
        value = allowed()
    except ValueError as error:
        raise SystemExit(str(error)) from None
    if sys.platform != "linux" or not math.isfinite(value):
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + (threads or usual_threads()) * THREAD + int(min(value, 2**20) * GIB)
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))


@contextlib.contextmanager
def bounded(threads: int | None = None) -> Iterator[None]:
    """Limit the memory within a `with` block. Raises `ValueError` if the setting is invalid."""
    allowed()
    if sys.platform != "linux":
        yield
        return
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    bound(threads)
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def sentence() -> str:
    """The error message for a simulation that ran out of memory."""
    value = allowed()
    bound = f"the limit of {value:g} GiB per process" if math.isfinite(value) else "the available memory"
    return (
        f"the simulation needs more than {bound}: lower the evaluations, the number of steps or of realisations, "
        f"or raise {SETTING}"
    )
