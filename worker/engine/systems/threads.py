"""The number of simulation threads of this process."""

from __future__ import annotations

import os


def usual_threads() -> int:
    """CLEARANCE_THREADS, else the number of cores available to this process."""
    given = os.environ.get("CLEARANCE_THREADS", "")
    return int(given) if given.isascii() and given.isdigit() and int(given) > 0 else len(os.sched_getaffinity(0))
