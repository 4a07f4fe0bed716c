"""On how many threads this process simulates."""

from __future__ import annotations

import os


def usual_threads() -> int:
    """CLEARANCE_THREADS, else the cores this process may use."""
    given = os.environ.get("CLEARANCE_THREADS", "")
    return int(given) if given.isascii() and given.isdigit() and int(given) > 0 else len(os.sched_getaffinity(0))
