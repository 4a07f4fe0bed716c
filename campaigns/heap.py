"""Garbage collection of a process: what it loads lives as long as it does, and is not searched for cycles.

The modules that start a process import this first, so that loading some 300,000 objects is not interrupted, and call
`loaded` once all is loaded. Nor are these objects searched when the process ends. A service of many threads takes its
memory from one place: `shared`.
"""

from __future__ import annotations

import ctypes
import gc

NEW = 10_000
"""Objects made between two searches, 14 times as many as usual: simulating and answering make few cycles."""

ARENAS = -8
"""glibc's name of the number of arenas, malloc.h: M_ARENA_MAX."""

_ENABLED = gc.isenabled()
gc.disable()


def loaded() -> None:
    """Exclude all that exists now from the search for cycles, unless the process searches for none."""
    if _ENABLED:
        gc.freeze()
        gc.set_threshold(NEW, 10, 10)
        gc.enable()


def shared() -> None:
    """All threads allocate in one arena; elsewhere than in glibc as they did.

    glibc gives each of the first 16 threads or more its own, and each keeps the most that it ever held: 40 MB more for
    a backend under load. Its threads take turns anyway, so that its answers take no longer.
    """
    allocate = getattr(ctypes.CDLL(None), "mallopt", None)
    if allocate is not None:
        allocate(ARENAS, 1)
