"""Garbage collection of a process: what it loads lives as long as it does, and is not searched for cycles.

The modules that start a process import this first, so that loading some 300,000 objects is not interrupted, and call
`loaded` once all is loaded. Nor are these objects searched when the process ends.
"""

from __future__ import annotations

import gc

NEW = 10_000
"""Objects made between two searches, 14 times as many as usual: simulating and answering make few cycles."""

_ENABLED = gc.isenabled()
gc.disable()


def loaded() -> None:
    """Exclude all that exists now from the search for cycles, unless the process searches for none."""
    if _ENABLED:
        gc.freeze()
        gc.set_threshold(NEW, 10, 10)
        gc.enable()
