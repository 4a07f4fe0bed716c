"""A bound on the memory of a process that simulates, so that one simulation can never take the machine's.

Source: setrlimit(2), RLIMIT_AS (Linux): address space, of which LLVM and the threads' heaps map far more than they use;
so it is counted from what the process has once it is ready. Start reading at `bound`.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from worker.systems.threads import usual_threads

SETTING = "CLEARANCE_CHILD_MEMORY"
"""The environment variable: GiB beyond what a ready process has, 0 for no bound."""

USUAL = 8.0
"""[GiB]"""

GIB = 2**30

THREAD = 128 * 2**20
"""Address space of a thread's stack and heap; 72 MiB were measured [bytes]."""


def allowed() -> float:
    """The setting [GiB]; infinite for no bound. Raises `ValueError`, with a sentence, for what is no number."""
    given = os.environ.get(SETTING, "").strip()
    try:
        value = float(given or USUAL)
    except ValueError:
        value = math.nan
    if not value >= 0:
        raise ValueError(f"invalid {SETTING} {given!r}: give a number of GiB such as 8, or 0 for no bound")
    return value or math.inf


def bound(threads: int | None = None) -> None:
    """Bound this process from now on; to be called once everything is imported. Ends it for an invalid setting.

    threads: on which it simulates, the usual ones by default.
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
    """The same bound while the block lasts; the limit of before is restored. Raises `ValueError` for the setting."""
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
    """What a simulation that ran out of memory is told with."""
    value = allowed()
    bound = f"the limit of {value:g} GiB per process" if math.isfinite(value) else "the available memory"
    return (
        f"the simulation needs more than {bound}: lower the evaluations, the number of steps or of realisations, "
        f"or raise {SETTING}"
    )
